"""warpwear: fine-mesh contact, wear and friction of rough surfaces.

The public names are listed in `__all__`; they are imported on first use, so that `import warpwear` and
`warpwear --help` stay quick. Everything else may change from release to release.
"""

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import TYPE_CHECKING, Any

from warpwear.lazy import resolve
from warpwear.version import __version__

if TYPE_CHECKING:
    from warpwear.contact.array.contact import ArrayContact
    from warpwear.contact.array.shear import ShearCertificate, ShearedContact
    from warpwear.contact.array.solve import solve_contact
    from warpwear.contact.array.tangential import solve_tangential
    from warpwear.contact.certificate import Certificate
    from warpwear.errors import ConvergenceError, InputError, InvariantError, StudyWarning
    from warpwear.history.snapshot import Snapshot
    from warpwear.inference.infer import infer
    from warpwear.inference.result import Inference
    from warpwear.result import Result
    from warpwear.runs.run import run, steps
    from warpwear.runs.step import RunStep
    from warpwear.study.study import Study
    from warpwear.sweeps.sweep import sweep
    from warpwear.sweeps.table import SweepResult

_PUBLIC = {
    "ArrayContact": "warpwear.contact.array.contact:ArrayContact",
    "Certificate": "warpwear.contact.certificate:Certificate",
    "ConvergenceError": "warpwear.errors:ConvergenceError",
    "Inference": "warpwear.inference.result:Inference",
    "InputError": "warpwear.errors:InputError",
    "InvariantError": "warpwear.errors:InvariantError",
    "Result": "warpwear.result:Result",
    "RunStep": "warpwear.runs.step:RunStep",
    "ShearCertificate": "warpwear.contact.array.shear:ShearCertificate",
    "ShearedContact": "warpwear.contact.array.shear:ShearedContact",
    "Snapshot": "warpwear.history.snapshot:Snapshot",
    "Study": "warpwear.study.study:Study",
    "StudyWarning": "warpwear.errors:StudyWarning",
    "SweepResult": "warpwear.sweeps.table:SweepResult",
    "infer": "warpwear.inference.infer:infer",
    "run": "warpwear.runs.run:run",
    "solve_contact": "warpwear.contact.array.solve:solve_contact",
    "solve_tangential": "warpwear.contact.array.tangential:solve_tangential",
    "steps": "warpwear.runs.run:steps",
    "sweep": "warpwear.sweeps.sweep:sweep",
}

__all__ = [
    "ArrayContact",
    "Certificate",
    "ConvergenceError",
    "Inference",
    "InputError",
    "InvariantError",
    "Result",
    "RunStep",
    "ShearCertificate",
    "ShearedContact",
    "Snapshot",
    "Study",
    "StudyWarning",
    "SweepResult",
    "__version__",
    "infer",
    "run",
    "solve_contact",
    "solve_tangential",
    "steps",
    "sweep",
]


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


if not TYPE_CHECKING:  # a type checker would let every name pass

    def __getattr__(name: str) -> Any:
        if name in _PUBLIC:
            return resolve(_PUBLIC[name])
        raise AttributeError(f"module 'warpwear' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
