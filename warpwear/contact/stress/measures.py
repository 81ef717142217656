"""Numbers of a stress that materials are compared with: of one state, and of a cycle between two.

A stress has the shape (6, …), its components in the order of `responses.COMPONENTS`.
"""

import math

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.elastic import LEAST_TORSION


def hydrostatic(stress: FloatArray) -> FloatArray:
    """Return the mean of the normal stresses, positive in tension."""
    return stress[:3].mean(axis=0)


def _second(stress: FloatArray) -> FloatArray:
    """Return J₂, half the sum of the squares of the deviator."""
    xx, yy, zz, xy, xz, yz = stress
    return ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 6.0 + xy**2 + xz**2 + yz**2


def mises(stress: FloatArray) -> FloatArray:
    """Return von Mises' stress, √(3 J₂)."""
    return np.sqrt(3.0 * _second(stress))


def principal(stress: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the largest principal stress, tension positive, and the largest shear, Tresca's (σ₁ − σ₃)/2.

    By the angle of the deviator in the plane of equal means (Malvern, Introduction to the Mechanics of a
    Continuous Medium, 1969, section 3.3).
    """
    mean, size = hydrostatic(stress), np.sqrt(_second(stress))
    xx, yy, zz = (values - mean for values in stress[:3])
    xy, xz, yz = stress[3:]
    third = xx * (yy * zz - yz**2) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    cube = np.where(size > 0.0, size, 1.0) ** 3
    angle = np.arccos(np.clip(1.5 * math.sqrt(3.0) * third / cube, -1.0, 1.0)) / 3.0
    return mean + 2.0 / math.sqrt(3.0) * size * np.cos(angle), size * np.sin(angle + math.pi / 3.0)


def check_limits(bending: float, torsion: float) -> None:
    """Raise InputError for fatigue limits whose ratio no criterion here is made for."""
    if not LEAST_TORSION <= torsion / bending <= 1.0:
        raise InputError(
            f"torsion = {torsion:g} is not possible with bending = {bending:g}; their ratio must be from "
            f"{LEAST_TORSION:.4g} to 1."
        )


def crossland(one: FloatArray, other: FloatArray, *, bending: float, torsion: float) -> FloatArray:
    """Return Crossland's equivalent shear of straight cycles between two stresses, fatigue beyond `torsion`.

    √J₂ of the amplitude + (3 t/f − √3) × the largest hydrostatic stress; f, t: limits of fully reversed
    bending and torsion (Crossland 1956, Proc. Int. Conf. on Fatigue of Metals, 138).
    """
    factor = 3.0 * torsion / bending - math.sqrt(3.0)
    amplitude = np.sqrt(_second(0.5 * (one - other)))
    return amplitude + factor * np.maximum(hydrostatic(one), hydrostatic(other))


def dang_van(one: FloatArray, other: FloatArray, *, bending: float, torsion: float) -> FloatArray:
    """Return Dang Van's equivalent shear of straight cycles between two stresses, fatigue beyond `torsion`.

    The largest shear of the amplitude + (3 t/f − 3/2) × the largest hydrostatic stress (Dang Van, Griveau and
    Message 1989, in Biaxial and Multiaxial Fatigue, EGF 3, 479).
    """
    factor = 3.0 * torsion / bending - 1.5
    return principal(0.5 * (one - other))[1] + factor * np.maximum(hydrostatic(one), hydrostatic(other))
