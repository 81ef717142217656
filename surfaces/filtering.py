"""The Gaussian filter of ISO 16610, in one and two dimensions."""

import numpy as np
import scipy.fft

from warpwear.surfaces.base import FloatArray


def low_pass(
    field: FloatArray, *, axis: int, pixel: float, cut_off: float, edge: str = "reflect"
) -> FloatArray:
    """Gaussian low-pass of heights [mm], shape (nx, ny), along an axis; pixel and cut-off in mm.

    ISO 16610-21: transmission exp(−π (α λc/λ)²), α² = ln 2/π, that is 2^−(λc/λ)²: half at the cut-off.
    Applied to the waves themselves, since weights sampled at pixels are off where the cut-off is only a few
    of them. edge: "reflect" goes on beyond the ends in the mirror, "grid-wrap" repeats the field.
    """
    count = field.shape[axis]
    if edge == "grid-wrap":
        frequency, shape = scipy.fft.rfftfreq(count, pixel), [1, 1]
        waves = scipy.fft.rfft(field, axis=axis)
    else:
        # the cosine transform is the Fourier transform of the field reflected at its outer edge
        frequency, shape = np.arange(count) / (2.0 * count * pixel), [1, 1]
        waves = scipy.fft.dct(field, type=2, axis=axis)
    shape[axis] = frequency.size
    waves *= np.exp2(-np.square(cut_off * frequency)).reshape(shape)
    if edge == "grid-wrap":
        smooth: FloatArray = scipy.fft.irfft(waves, n=count, axis=axis, overwrite_x=True)
    else:
        smooth = scipy.fft.idct(waves, type=2, axis=axis, overwrite_x=True)
    return smooth


def areal_low_pass(field: FloatArray, *, pixel: tuple[float, float], cut_off: float) -> FloatArray:
    """Areal Gaussian low-pass (ISO 16610-61) of complete heights [mm], shape (nx, ny); pixel, cut-off [mm].

    Isotropic: the product of the filters along both axes. Beyond its edges the field is mirrored, so that no
    height is lost there; within half a cut-off of them the result knows only one side.
    """
    along = low_pass(field, axis=0, pixel=pixel[0], cut_off=cut_off)
    return low_pass(along, axis=1, pixel=pixel[1], cut_off=cut_off)
