"""A slide tells what changes from step to step of a pair of bodies, one of which may be displaced."""

import warp as wp

wp.set_module_options({"enable_backward": False})


@wp.struct
class Slide:
    """Describes a step, or a part of one; passes read it from an array of one."""

    number: wp.int32  # of the step in its replay
    rows: wp.int32  # of cells that are visited
    shift: wp.int32  # the disc's row under the counter-body's first
    window: wp.int32  # rows of the disc that pass over one of the counter-body
    first_column: wp.int32  # first column that was ever touched, and the one after the last
    end_column: wp.int32
    start: wp.float64  # sliding distance at its start and at its end [mm]
    end: wp.float64
    of_counter: wp.float64  # K ΔL of what leaves at once [mm³/N]
    of_disc: wp.float64
    pending_counter: wp.float64  # K ΔL of what leaves in pieces [mm³/N]
    pending_disc: wp.float64
    shear_counter: wp.float64  # depth that a cell in contact all the step loses by its shear [mm]
    shear_disc: wp.float64
    own: wp.float64  # compliance that is not wear [mm³/N]
    full_depth: wp.float64  # overlap of a cell at the hardness [mm]; NONE: the disc springs back
    approach: wp.float64  # [mm]
    slip_of_gap: wp.float64  # of a cycle [mm], over a gap [mm]
    ahead: wp.float64  # of what slips grew by in the last jump, to the end of this one
    slipping_counter: wp.float64  # K ΔL over the distance of a cycle, of what slips by cells [mm²/N]
    slipping_disc: wp.float64
    counter_moves: wp.int32  # 1 where pressures move with the counter-body, so that the disc sees their mean
    reference: wp.float64  # squares are those of the deviation from it [MPa]


@wp.func
def beneath(row: wp.int32, shift: wp.int32, rows: wp.int32):
    """Return the disc's row under a row of the counter-body; 0 ≤ shift < rows."""
    displaced = row + shift
    return wp.where(displaced < rows, displaced, displaced - rows)
