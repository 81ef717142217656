"""What cells have of their own follows from what their bodies have lost: films on them, a bearing curve.

Films: cells are bare of film where they wore, and that changes their caps. A body's cell has lost its film
where more than the film's thickness was worn off it since the film was last whole. A cell of the contact is
bare where that holds of every body that carries one. Fields are those of the counter-body, or of patches; the
disc's rows lie under them displaced, as in `sliding`. The loops are C++: native/running_in/sources.h.
"""

import warp as wp

from warpwear.kernels.cells import Cells


@wp.struct
class Coat:
    """Holds one body's film by fields; these have no rows where there is none, or it never forms anew."""

    wear: wp.array2d(dtype=Cells)  # of the body, from its unworn surface [mm]
    whole: wp.array2d(dtype=Cells)  # that wear, when the film was last whole [mm]
    seen: wp.array2d(dtype=Cells)  # that wear, at the end of the last step that could change it [mm]
    rubbed: wp.array2d(dtype=Cells)  # sliding distance at which it last changed [mm]


@wp.struct
class Films:
    """Holds the films of both bodies, and what they make of the cells of the contact."""

    counter: Coat
    disc: Coat
    thickness: wp.float64  # [mm]
    regrowth: wp.float64  # sliding distance without wear after which a film is whole again [mm]
    cap_filmed: wp.float64  # over the hardness
    cap_bare: wp.float64
    shear_filmed: wp.float64  # shear strength over that of a bare cell


@wp.struct
class Curve:
    """Describes a logistic bearing area curve φ(z)."""

    middle: wp.float64  # m [mm]
    scale: wp.float64  # s [mm]; 0: it bears everywhere


@wp.struct
class Sources:
    """What the properties of cells follow from as a step begins, beside their Ks."""

    films: Films
    curve: Curve
    wear_counter: wp.array2d(dtype=Cells)  # where there are layers [mm]
    wear_disc: wp.array2d(dtype=Cells)  # where there are layers or a curve [mm]
    layered: wp.int32  # 1 where bodies have materials by worn depth
    disc_rows: wp.int32  # rows of a disc that may be displaced; 0 of none
    stiffens: wp.int32  # 1 where the stiffness of every cell is made with the others
