"""[fatigue]: what the stress of a cycle below the surface is compared with."""

from warpwear.study.keys import Length, Pressure, Section, key


class Fatigue(Section):
    """The section [fatigue] says which fatigue limits the disc has."""

    bending: Pressure = key(..., "fatigue limit of the disc under fully reversed bending, such as '500 MPa'")
    torsion: Pressure = key(
        ...,
        "that under fully reversed torsion, 0.58 to 1 of it: what Crossland and Dang Van are compared with",
    )
    length: Length = key(
        "30 um",
        "side of the square, parallel to the surface, over which stresses are averaged first",
        assumed="some grains of a steel, 20 to 50 µm; at an edge the largest value grows as it shrinks",
    )
