"""Files that tell whether they are what was written, by a digest in the room before their HDF5 part.

They open with a user block of `HEADER` bytes, a line "MARK DIGEST": the digest of everything behind it is
checked before the HDF5 library sees any of it, which takes lost blocks for zeros and does not survive every
damage.
"""

import hashlib
import platform
from importlib.metadata import PackageNotFoundError, version
from io import BufferedIOBase
from pathlib import Path
from typing import Any

from warpwear.version import __version__

HEADER = 512


def seal(file: BufferedIOBase, mark: str) -> None:
    """Write the mark and the digest of a finished file, open for reading and writing."""
    digest = digest_of(file)
    file.seek(0)
    file.write(f"{mark} {digest}\n".encode())


def words_of(file: BufferedIOBase) -> list[str]:
    """Of the first line of a file, open at its beginning: those of its mark, and its digest."""
    return file.readline(HEADER).decode(errors="replace").split()


def digest_of(file: BufferedIOBase) -> str:
    """Of everything behind the header."""
    file.seek(HEADER)
    return hashlib.file_digest(file, "blake2b").hexdigest()


def has_mark(path: Path, mark: str) -> bool:
    """Whether a file opens with a mark, damaged or not."""
    try:
        with path.open("rb") as file:
            return file.read(len(mark)) == mark.encode()
    except OSError:
        return False


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
