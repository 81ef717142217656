"""Room on a disk, made sure of before the HDF5 library writes: it does not survive a disk that is full."""

import errno
import os
import shutil
import tempfile
from pathlib import Path

#: What a file system says that cannot set room aside.
CANNOT = (errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL, errno.EPERM)


def make_sure_of(size: int, folder: Path, *, offset: int = 0) -> None:
    """Raises OSError unless a file in the folder can grow by so many bytes beyond an offset [B].

    Where the system can, the room is set aside for a moment: a quota and a limit to the size of a file show
    only then.
    """
    free = shutil.disk_usage(folder).free
    if free < size:
        raise OSError(errno.ENOSPC, f"{size / 2**20:.0f} MiB are needed, {free / 2**20:.0f} MiB are free")
    if not hasattr(os, "posix_fallocate"):
        return
    with tempfile.TemporaryFile(dir=folder) as file:
        try:
            os.posix_fallocate(file.fileno(), offset, size)
        except OSError as error:
            if error.errno in CANNOT:
                return
            why = os.strerror(error.errno or errno.ENOSPC)
            raise OSError(error.errno, f"{(offset + size) / 2**20:.0f} MiB are needed: {why}") from error
