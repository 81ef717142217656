"""Copies what cells printed and drew into the pages, for those who read them where no site is made.

python docs/make_outputs.py, after the site was made: it takes what the site's cache has.
"""

import base64
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS / "extensions"))

from jupyter_cache import get_cache  # noqa: E402
from myst_nb.core.read import read_myst_markdown_notebook  # noqa: E402
from myst_parser.config.main import MdParserConfig  # noqa: E402
from outputs import BEGIN, END, cells, without  # noqa: E402
from PIL import Image  # noqa: E402
from streams import joined  # noqa: E402

CACHE = DOCS.parent / "build" / "site-cache" / "pages"
PICTURES = DOCS / "pictures" / "outputs"
#: Folders whose pages a reader meets first.
FOLDERS = ("start", "tutorials", "how-to")
#: Widest picture, and the colours that it is reduced to.
WIDTH, COLOURS = 760, 64
#: Lines of an output that are shown at most.
LINES = 60


def main() -> None:
    for old in PICTURES.glob("*.png"):
        old.unlink()
    PICTURES.mkdir(exist_ok=True)
    for page in sorted(page for folder in FOLDERS for page in (DOCS / folder).glob("*.md")):
        text = without(page.read_text(encoding="utf-8"))
        if cells(text):
            page.write_text(with_outputs(page, text), encoding="utf-8")


def with_outputs(page: Path, text: str) -> str:
    """Return a page with a copy of what came out behind each of its cells that shows something."""
    notebook = read_myst_markdown_notebook(text, config=MdParserConfig())
    try:
        done = get_cache(CACHE).merge_match_into_notebook(notebook)[1]
    except KeyError:
        print(f"{page.relative_to(DOCS)}: not in the site's cache, left without outputs")
        return text
    outputs = [cell.outputs for cell in done.cells if cell.cell_type == "code"]
    name = f"{page.parent.name}-{page.stem}"
    whole, start, number = "", 0, 0
    for (end, source, digest), shown in zip(cells(text), outputs, strict=True):
        whole, start = whole + text[start:end], end
        lines: list[str] = []
        kept = [one for one in joined(shown) if one.get("name") != "stderr"]
        for output in kept if ":tags: [remove-cell]" not in source else []:
            data: dict[str, Any] = output.get("data", {})
            if "image/png" in data:
                number += 1
                store(data["image/png"], PICTURES / f"{name}-{number}.png")
                lines += [f"![What the cell drew](../pictures/outputs/{name}-{number}.png)", ""]
            elif printed := output.get("text") or data.get("text/plain"):
                rows = printed.rstrip().splitlines()
                lines += ["```text", *rows[:LINES], *["..."] * (len(rows) > LINES), "```", ""]
        if lines:
            whole += "\n".join(["", BEGIN.format(digest), "", *lines, END, ""])
    return whole + text[start:]


def store(encoded: str, path: Path) -> None:
    """Write a picture of few colours."""
    image = Image.open(BytesIO(base64.b64decode(encoded))).convert("RGB")
    image.thumbnail((WIDTH, 4 * WIDTH))
    image.quantize(COLOURS).save(path, optimize=True)


if __name__ == "__main__":
    main()
