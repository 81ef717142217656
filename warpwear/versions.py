"""What a result was made with: it can be made again only with the same."""

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from warpwear import __version__

#: Whose numbers a result depends on.
PACKAGES = ("warp-lang", "numpy", "scipy", "h5py")


def versions(device: Any) -> dict[str, str]:
    """Versions of warpwear, Python and packages, the system, the processor. device: Warp's."""
    return {
        "warpwear": __version__,
        "python": platform.python_version(),
        **{name: _version(name) for name in PACKAGES},
        "system": platform.platform(),
        "device": str(device.name) if device.is_cuda else platform.processor() or platform.machine(),
    }


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:  # not installed as a package
        return "unknown"
