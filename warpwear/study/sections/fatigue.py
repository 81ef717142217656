"""[fatigue]: what the stress of a cycle below the surface is compared with."""

from warpwear.study.keys import Length, Pressure, Section, key


class Fatigue(Section):
    """The section [fatigue] says which fatigue limits the disc has."""

    bending: Pressure = key(...)
    torsion: Pressure = key(...)
    length: Length = key("30 um")
