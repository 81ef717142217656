"""What tests of two scales share: a quick study, and one of each kind."""

from typing import Any

from warpwear import Study

QUICK = {
    "grid.cell": "10 um",
    "disc.synthetic.cut_off": "20 um",  # what such cells resolve
    "patches.macro_cell": "50 um",
    "patches.width": "50 um",
    "sliding.distance": "60 mm",
    "output.snapshots": ["0.3 mm", "3 mm"],
}
KINDS = {
    "no bulk": {"patches.bulk": "none"},
    "bulk": {},
    "bulk that follows": {"contact.bulk_update": "updated"},
    "soft bulk": {"contact.bulk_stiffness": "3e4 N/mm^3"},
    "elastic, explicit": {
        "contact.stiffness": "2e5 N/mm^3",
        "stepping.scheme": "explicit",
        "stepping.force": True,
        "stepping.largest": "0.3 mm",
        "sliding.distance": "3 mm",
    },
    "load": {"patches.coupling": "load"},
    "some of the area": {"grid.extent": "1.8 mm", "patches.macro_cell": "300 um", "patches.width": "100 um"},
}


def quick(**changes: Any) -> Study:
    return Study.load("two-scale").replace(QUICK | {k.replace("__", "."): v for k, v in changes.items()})


def of_kind(kind: str) -> Study:
    return quick().replace(KINDS[kind])
