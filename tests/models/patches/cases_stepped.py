"""What tests of the steps of two scales share: a model that is advanced by hand."""

from functools import cache

from cases_two_scale import quick

from warpwear import Study
from warpwear.engine.executor import Executor, Field
from warpwear.grid import FloatArray, Grid
from warpwear.models.patches.local import TwoScaleModel
from warpwear.models.patches.shares import LoadSharing
from warpwear.study.surface import surface_in


@cache
def _heights_on(grid: Grid) -> FloatArray:
    return surface_in(quick()).heights(grid.x, grid.y)


class Stepped:
    """A model, advanced step by step."""

    def __init__(self, study: Study, *, device: str = "cpu", threads: int | None = None) -> None:
        self.study, self.patches = study, study.patch_layout
        self.executor = Executor(self.patches.grid, device=device, threads=threads)
        self.model = TwoScaleModel(study.contact_task, self.patches, _heights_on(study.cells), self.executor)

    def gap(self) -> FloatArray:
        """Of every patch, shape (patches, side, side)."""
        n = self.patches.side
        rows = self.executor.to_numpy(self.model.contact.gap)
        return rows.reshape(self.patches.count, n, -1)[:, :, :n].copy()


def trial(sharing: LoadSharing) -> tuple[Field, Field]:
    """Base and offset of the approach of every patch [mm]."""
    return sharing.base, sharing.offset
