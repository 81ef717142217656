"""Bodies of layers and gradients, and tasks of them, shared by tests."""

from typing import Any

import reference

from warpwear.laws.archard import WearLaw
from warpwear.laws.depth_profile import DepthProfile, LayerMaterial
from warpwear.laws.form import Form
from warpwear.laws.task import ContactTask

COAT = DepthProfile(
    (0.0, 2.0e-3, 2.5e-3),
    (LayerMaterial(1e-10, 2e4, name="coat"), LayerMaterial(3e-8, 4e3, name="bond"), LayerMaterial(2e-9, 8e3)),
)
SKIN = DepthProfile((0.0, 1.0e-3), (LayerMaterial(4e-9, 5e3, name="skin"), LayerMaterial(1e-9, 9e3)))
CASE = DepthProfile(
    (0.0, 1.0e-3, 4.0e-3), (LayerMaterial(1e-9), LayerMaterial(5e-9), LayerMaterial(2e-9)), graded=True
)
PLAIN = DepthProfile((0.0,), (LayerMaterial(1e-9, 9e3),))
Profiles = tuple[DepthProfile, DepthProfile]


def task_of(profiles: Profiles, *, load: float, form: Form | None = None, **more: Any) -> ContactTask:
    """A task of bodies that are layered, of unworn surfaces' K and cap."""
    tops = [profile.materials[0] for profile in profiles]
    return ContactTask(
        load=load,
        hardness=min(top.hardness for top in tops),
        form=form or Form(),
        wear=(WearLaw(tops[0].wear), WearLaw(tops[1].wear)),
        compliance=1e-7,
        profiles=profiles,
        **more,
    )


def layered(profile: DepthProfile) -> reference.Layered:
    """The same body as the reference has it."""
    materials = profile.materials
    return reference.Layered(
        profile.depths, tuple(m.wear for m in materials), tuple(m.hardness for m in materials)
    )


HALF_SPACE = {"half_space": True, "modulus": 1.1e5}
