"""warpwear: fine-mesh contact, wear and friction of rough surfaces.

The public names stand in `__init__.pyi`, for type checkers too; they are imported on first use, so that
`import warpwear` and `warpwear --help` stay quick. Everything else may change from release to release.
"""

import re
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

from warpwear.lazy import resolve
from warpwear.version import __version__ as __version__

_STUB = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
#: Public name -> place of what it stands for.
_PUBLIC = {name: f"{module}:{name}" for module, name in re.findall(r"^from (\S+) import (\w+)", _STUB, re.M)}

__all__ = sorted(_PUBLIC)


def _register(wing: str) -> None:
    """Make warpwear.WING of a folder beside this one: a checkout has kernels/ and surfaces/ at its top."""
    folder = Path(__file__).parent.parent / wing
    name = f"{__name__}.{wing}"
    spec = spec_from_file_location(name, folder / "__init__.py", submodule_search_locations=[str(folder)])
    assert spec is not None
    assert spec.loader is not None
    package = module_from_spec(spec)
    sys.modules[name] = package
    spec.loader.exec_module(package)
    globals()[wing] = package


for _wing in ("kernels", "surfaces"):
    if not (Path(__file__).parent / _wing).is_dir():
        _register(_wing)


def __getattr__(name: str) -> Any:
    if name in _PUBLIC:
        return resolve(_PUBLIC[name])
    raise AttributeError(f"module 'warpwear' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
