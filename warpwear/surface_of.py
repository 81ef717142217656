"""From the [disc] section of a study to its surface."""

from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.running_in import Logistic
from warpwear.sections_bodies import Disc
from warpwear.study import Study
from warpwear.surfaces.base import Surface

#: Points along a side at which a bearing area curve is taken.
FINE = 1000


def surface_in(study: Study) -> Surface:
    """What the sphere slides on: the disc's surface, smooth in the macro model. Raises InputError."""
    if study.study.model == "macro":
        from warpwear.surfaces.synthetic import Flat

        return Flat()
    return surface_of(study.disc)


def bearing_curve_of(study: Study) -> Logistic:
    """The bearing area curve of the study's disc over its domain. Raises InputError for a flat one."""
    grid = study.cells
    places = np.linspace(grid.x[0], grid.x[-1], FINE)
    heights = surface_of(study.disc).heights(places, places)
    try:
        return Logistic.fitted(heights)
    except ValueError as error:
        raise InputError(f"wear.law = 'bearing-curve' needs a rough disc: {error}.") from error


def surface_of(disc: Disc) -> Surface:
    """The disc's surface. Raises InputError for a file that cannot be used."""
    if disc.synthetic is not None:
        from warpwear.surfaces.milled import Milled
        from warpwear.surfaces.self_affine import SelfAffine
        from warpwear.surfaces.synthetic import Flat

        given: dict[str, Any] = {
            name: getattr(disc.synthetic, name)
            for name in ("ra", "sq", "hurst", "roll_off", "cut_off", "seed", "period")
        }
        if disc.synthetic.kind == "flat":
            return Flat()
        if disc.synthetic.kind == "self-affine":
            return SelfAffine(**given)
        return Milled(
            **given, feed=disc.synthetic.feed, fine_ra=disc.synthetic.fine_ra, lay=disc.synthetic.lay
        )
    from warpwear.surfaces.measured import read_measured

    return read_measured(
        str(disc.surface),
        extend=disc.extend,
        pixel=disc.pixel,
        height_unit=disc.height_unit,
        array=disc.array,
        height_sign=disc.height_sign,
        crop=disc.crop,
        sliding_axis=disc.sliding_axis,
        outliers=disc.outliers,
        level=disc.level,
        s_filter=disc.s_filter,
        l_filter=disc.l_filter,
    )
