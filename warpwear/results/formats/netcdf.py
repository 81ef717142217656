"""Write a result as one NetCDF file: history, patches and fields, labelled after the CF conventions."""

from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.results import writer
from warpwear.results.formats.bodies import ON_THE_TRACK, WRITABLE, Files, Job
from warpwear.results.frames import courses
from warpwear.version import __version__

h5netcdf = lazy.module("h5netcdf")

#: Name of the file.
NAME = "result.nc"
#: How densely fields are packed: the least, which costs a fifth of the time and a tenth of the room.
PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def netcdf_files(job: Job) -> Files:
    """Name the one file of a result."""
    yield NAME, partial(write_netcdf, job)


def write_netcdf(job: Job, path: Path) -> None:
    """Write history, patches and the snapshots asked for, of which one at a time is in memory.

    Dimensions are those of `to_xarray`. Heights of the worn bodies stand beside the fields.
    """
    result = job.result
    about = courses(result, job.numbers)
    require_free_space(path, about.nbytes + _field_bytes(job))
    written = datetime.now(UTC).isoformat(timespec="seconds")
    about.attrs["history"] = f"{written}: exported by warpwear {__version__}"
    about.to_netcdf(path, engine="h5netcdf")
    swept = result.study.is_swept
    with h5netcdf.File(path, "a") as file:
        for place, number in enumerate(job.numbers):
            for name in ("fields", "track_fields") if swept else ("fields",):
                sheet = job.sheet(name, number, whole_disc=True)
                along = "track_x" if name == "track_fields" else "x"
                for key, values in sheet.fields.items():
                    if place == 0:
                        _declare(file, key, along, values)
                    file.variables[key][place] = values


def _field_bytes(job: Job) -> int:
    """Bound the size of all fields [B], which are packed in the file."""
    result = job.result
    long = result.track_x.size if result.study.is_swept else 0
    rows = (max(long, result.x.size) if name in ON_THE_TRACK else result.x.size for name in job.fields)
    return 8 * len(job.numbers) * result.y.size * sum(rows)


def require_free_space(path: Path, nbytes: int) -> None:
    """Raise OSError, naming it, unless a new file has room: the library does not survive a full disk."""
    try:
        writer.require_free_space(path.parent, nbytes + writer.SPACE_FOR_THE_REST)
    except OSError as error:
        raise OSError(error.errno, f"{path.name}: {error.strerror}") from error


def _declare(file: Any, name: str, along: str, values: "np.ndarray[Any, Any]") -> None:
    """Make the variable of a field, for all snapshots. values: those of one."""
    quantity = WRITABLE[name]
    variable = file.create_variable(
        name, ("distance", along, "y"), values.dtype, chunks=(1, *values.shape), fillvalue=np.nan, **PACKED
    )
    variable.attrs.update(units=quantity.units, long_name=quantity.meaning)
