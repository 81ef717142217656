"""What a file says of itself: whether it is still what was written, and what it was made with.

A sealed file opens with a user block of `HEADER` bytes that holds a line "MARK DIGEST". The digest is that of
everything behind the block, and is checked before the HDF5 library sees any of it: that library takes lost
blocks for zeros and does not survive every damage.
"""

import hashlib
import platform
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from io import BufferedIOBase
from pathlib import Path
from typing import Any

import h5py

from warpwear.version import __version__

#: Size of the user block [B].
HEADER = 512
#: Packages whose numbers a result depends on.
PACKAGES = ("warp-lang", "numpy", "scipy", "h5py")


def seal(file: BufferedIOBase, mark: str) -> None:
    """Write the mark and the digest of a finished file, open for reading and writing."""
    digest = digest_of(file)
    file.seek(0)
    file.write(f"{mark} {digest}\n".encode())


def open_to_read(path: Path) -> h5py.File:
    """Open an HDF5 file to read, and wait up to two seconds for one that is locked. Raises OSError.

    A process that starts holds whatever was open for a moment, and with it the lock of a file closed since.
    """
    for _ in range(100):
        with suppress(BlockingIOError):
            return h5py.File(path, "r")
        time.sleep(0.02)
    return h5py.File(path, "r")


@contextmanager
def sealing(path: Path, mark: str) -> Iterator[None]:
    """Seal a finished file while others read it: the digest of a large one takes as long as a table."""
    with ThreadPoolExecutor(1) as pool:
        sealed = pool.submit(_seal, path, mark)
        yield
        sealed.result()


def _seal(path: Path, mark: str) -> None:
    with path.open("r+b") as file:
        seal(file, mark)


def read_header(file: BufferedIOBase) -> list[str]:
    """Return the words of the first line of a file that is open at its beginning: mark, and digest."""
    return file.readline(HEADER).decode(errors="replace").split()


def digest_of(file: BufferedIOBase) -> str:
    """Compute the digest of everything behind the header."""
    file.seek(HEADER)
    return hashlib.file_digest(file, "blake2b").hexdigest()


def has_mark(path: Path, mark: str) -> bool:
    """Whether a file opens with a mark, damaged or not."""
    try:
        with path.open("rb") as file:
            return file.read(len(mark)) == mark.encode()
    except OSError:
        return False


def versions(device: Any) -> dict[str, str]:
    """Return versions of warpwear, Python and `PACKAGES`, the system, and the processor. device: Warp's."""
    return {
        "warpwear": __version__,
        "python": platform.python_version(),
        **{name: _version(name) for name in PACKAGES},
        "system": platform.platform(),
        "device": str(device.name) if device.is_cuda else platform.processor() or platform.machine(),
    }


@cache
def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:  # not installed as a package
        return "unknown"
