"""The directive `example` runs a script of examples/ and shows its question, pictures, output and source."""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from ast import get_docstring, parse
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

ROOT = Path(__file__).parents[2]


def made(script: Path, cache: Path) -> Path:
    """Return the folder with what the script printed (output.txt) and drew (*.png); run it if need be.

    What a script leaves is kept until the script or anything of the package changes.
    """
    digest = hashlib.sha256(script.read_bytes())
    for wing in ("warpwear", "kernels", "surfaces"):
        for file in sorted((ROOT / wing).rglob("*.py")):
            digest.update(file.read_bytes())
    kept = cache / f"{script.stem}-{digest.hexdigest()[:16]}"
    if kept.is_dir():
        return kept
    with tempfile.TemporaryDirectory() as empty:
        done = subprocess.run(
            [sys.executable, str(script)],
            cwd=empty,
            env={**os.environ, "MPLBACKEND": "agg", "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )
        if done.returncode:
            raise RuntimeError(f"examples/{script.name} fails:\n{done.stderr}")
        for older in cache.glob(f"{script.stem}-*"):
            shutil.rmtree(older)
        kept.mkdir(parents=True)
        (kept / "output.txt").write_text(done.stdout, encoding="utf-8")
        for picture in sorted(Path(empty).glob("*.png")):
            shutil.copy(picture, kept)
    return kept


class Example(SphinxDirective):
    """Show one example; the argument is its name without .py."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the section of the example."""
        script = ROOT / "examples" / f"{self.arguments[0]}.py"
        self.env.note_dependency(str(script))
        source = script.read_text(encoding="utf-8")
        question, _, rest = (get_docstring(parse(source)) or "").partition("\n")
        code = source.partition('"""\n\n')[2]
        folder = made(script, Path(self.config.gallery_cache))
        output = (folder / "output.txt").read_text(encoding="utf-8").rstrip()
        lines = [f"## {question}", "", rest.strip(), ""]
        for picture in sorted(folder.glob("*.png")):
            place = os.path.relpath(picture, Path(self.env.doc2path(self.env.docname)).parent)
            lines += [f"```{{image}} {place}", f":alt: {question}", ":class: picture", "```", ""]
        lines += ["```text", output, "```", ""]
        lines += [f"````{{dropdown}} examples/{script.name}", "```python", code.rstrip(), "```", "````", ""]
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)


def setup(app: Any) -> dict[str, bool]:
    """Tell Sphinx of the directive."""
    app.add_config_value("gallery_cache", "", "env")
    app.add_directive("example", Example)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
