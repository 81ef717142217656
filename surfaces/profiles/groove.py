"""The section of a worn groove in a profile, with the error that the surface beside it tells."""

from warpwear.surfaces.profiles.profile import Profile
from warpwear.surfaces.worn.track import Track, find_track


def find_groove(profile: Profile, *, degree: int = 1, width: float | None = None) -> Track:
    """Find the worn groove across a profile: a track of which one section is known.

    degree: of the polynomial through the profile beside it, which is its reference; width [mm]: of the groove
    with its pile-up, None to find it. Raises InputError where there is none, or too little beside it.
    """
    return find_track(
        profile.heights[None], pixel=(profile.spacing, profile.spacing), degree=degree, width=width
    )
