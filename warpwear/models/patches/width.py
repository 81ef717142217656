"""Refuse patches that suit neither the contact nor, where they stand for more, the roughness."""

import math

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.patches import Patches
from warpwear.study.rules_track import worn_patch
from warpwear.study.study import Study
from warpwear.surfaces.spectrum import autocorrelation_length, power_spectrum, suggested_roll_off

#: Width below which a patch is too narrow, over the estimated roll-off length: the estimate scatters by 6 %
#: between surfaces of the same spectrum.
CERTAIN = 0.9


def refuse_unsuitable(study: Study, patches: Patches, heights: FloatArray) -> None:
    """Refuse macro cells wider than the contact, and samples narrower than the roughness, by InputError.

    heights: [mm], over the domain.
    """
    _refuse_wide(study, heights)
    if not patches.cover_everything and heights.max() > heights.min():  # smooth ones have no roll-off
        _refuse_narrow(patches, heights)


def _refuse_wide(study: Study, heights: FloatArray) -> None:
    """Refuse macro cells wider than the contact: 2 √(a² + 2 R R_p), with a of smooth bodies, R_p the peak.

    a is that of the worn patch, Hertz's, or that of a load at the hardness.
    """
    curvature = max(study.counter.form.along, study.counter.form.across)
    if curvature == 0.0:
        return
    hertz = study.hertz.radius if study.hertz else 0.0
    load = max(block.load for block in study.blocks)
    smooth = max(0.5 * worn_patch(study), hertz, math.sqrt(load / (math.pi * study.hardness)))
    width = 2.0 * math.sqrt(smooth**2 + 2.0 * max(float(heights.max()), 0.0) / curvature)
    if study.patches.macro_cell > width:
        raise InputError(
            f"patches.macro_cell = {1e3 * study.patches.macro_cell:g} µm is larger than the contact, which "
            f"ends about {1e3 * width:.3g} µm wide: one patch would carry all of the load; allowed are "
            "smaller ones."
        )


def _refuse_narrow(patches: Patches, heights: FloatArray) -> None:
    """Refuse patches that do not hold the longest waves: each sees a hill or valley, not the roughness."""
    cell = patches.domain.cell
    spectrum = power_spectrum(heights, pixel=(cell, cell))
    correlation = autocorrelation_length(heights, pixel=(cell, cell))
    roll_off = suggested_roll_off(spectrum, correlation=correlation, resolved=2.0 * cell)
    width = patches.side * cell
    if roll_off.wavelength is None:
        raise InputError(
            f"patches.width = {1e3 * width:g} µm cannot stand for a macro cell: the roughness has no "
            "roll-off length within the domain; allowed are patches as large as patches.macro_cell."
        )
    if width < CERTAIN * roll_off.wavelength:
        raise InputError(
            f"patches.width = {1e3 * width:g} µm is narrower than the roll-off length of the roughness, "
            f"about {1e3 * roll_off.wavelength:.4g} µm (from: {roll_off.source}), so it cannot stand for a "
            "macro cell; allowed are wider patches, or ones as large as patches.macro_cell."
        )
