"""Whether patches that stand for more than themselves are wide enough for the roughness."""

from typing import TYPE_CHECKING

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.patches import Patches
from warpwear.surfaces.spectrum import autocorrelation_length, power_spectrum, suggested_roll_off

if TYPE_CHECKING:
    from warpwear.surfaces.spectrum import RollOff

#: The estimate of a roll-off length scatters by 6 % between surfaces of the same spectrum: a patch
#: is too narrow below so much of it.
CERTAIN = 0.9


def roll_off_of(heights: FloatArray, *, cell: float) -> "RollOff":
    """Of the roughness on a grid, as `warpwear surface` estimates it. heights, cell: [mm]."""
    pixel = (cell, cell)
    correlation = autocorrelation_length(heights, pixel=pixel)
    return suggested_roll_off(
        power_spectrum(heights, pixel=pixel), correlation=correlation, resolved=2.0 * cell
    )


def refuse_narrow(patches: Patches, heights: FloatArray) -> None:
    """Raises InputError for representative patches narrower than the roll-off length of the roughness.

    A patch that does not hold the longest waves sees a part of a hill or of a valley, not the roughness.
    heights: [mm], over the domain; smooth ones have no roll-off.
    """
    if patches.cover_everything or heights.max() == heights.min():
        return
    cell = patches.domain.cell
    found = roll_off_of(heights, cell=cell)
    width = patches.side * cell
    if found.wavelength is None:
        raise InputError(
            f"macro.patch = {1e3 * width:g} µm cannot stand for a macro cell: the roughness has no roll-off "
            "length within the domain; allowed are patches as large as macro.cell."
        )
    if width < CERTAIN * found.wavelength:
        raise InputError(
            f"macro.patch = {1e3 * width:g} µm is narrower than the roll-off length of the roughness, about "
            f"{1e3 * found.wavelength:.4g} µm (from: {found.source}), so it cannot stand for a macro cell; "
            "allowed are wider patches, or ones as large as macro.cell."
        )
