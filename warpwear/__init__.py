"""warpwear: fine-mesh contact, wear and friction of rough surfaces.

The public names are `Study`, `run`, `Result` and `InputError`; they are imported on first use, so that
`import warpwear` and `warpwear --help` stay quick.
"""

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from warpwear.errors import ConvergenceError, InputError
    from warpwear.results import Result
    from warpwear.runner import run
    from warpwear.study import Study

__version__ = "0.1.0"
__all__ = ["ConvergenceError", "InputError", "Result", "Study", "__version__", "run"]

# In a checkout kernels/ and surfaces/ stand beside this folder, in a wheel inside it.
if not (Path(__file__).parent / "kernels").is_dir():
    __path__.append(str(Path(__file__).parent.parent))

_HOME = {
    "ConvergenceError": "warpwear.errors",
    "InputError": "warpwear.errors",
    "Result": "warpwear.results",
    "Study": "warpwear.study",
    "run": "warpwear.runner",
}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'warpwear' has no attribute {name!r}")
