"""What a feature forgets to say is refused, by an error that names it; and how often its hooks are asked."""

from collections import Counter
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import pytest
from cases_features import PARTICLES, STEPS, STUDIES, Debris, attach, model_of, needs_transforms, rows_of
from cases_track import small

import warpwear
from warpwear.engine.executor import Executor, arguments
from warpwear.engine.program import Program
from warpwear.errors import InputError, InvariantError
from warpwear.history import quantities
from warpwear.history.recorder import Ledger
from warpwear.history.snapshot import Snapshot, lowered
from warpwear.kernels.cells import Curve
from warpwear.kernels.running_in.pieces import Footprint
from warpwear.laws.task import FeatureLaw
from warpwear.models.features import particles
from warpwear.models.features.feature import Feature, Site
from warpwear.models.features.features import Features
from warpwear.runs.invariants import Invariants
from warpwear.study.sections.wear import Wear

HOOKS = "before_search", "before_wear", "after_wear", "between", "end_step", "after_part"


class Witness(Feature):
    """Counts how often each hook is done."""

    def __init__(self, site: Site) -> None:
        self.site, self.seen = site, Counter[str]()

    def _count(self, hook: str, program: Program) -> None:
        program.call(lambda: self.seen.update([hook]))

    def drain(self) -> bool:
        return False


for _hook in HOOKS:
    setattr(Witness, _hook, lambda self, program, place, hook=_hook: self._count(hook, program))


LAW = FeatureLaw()


def registered(
    monkeypatch: pytest.MonkeyPatch, kind: Any, law: FeatureLaw = LAW, key: str = "wear.disc"
) -> list[Any]:
    """Let every contact have a feature by the name of a key, which is made of its site; return those made."""
    made: list[Any] = []

    def make(_: Any, site: Site) -> Feature:
        made.append(kind(site))
        return made[-1]

    monkeypatch.setattr(Wear, "features", property(lambda _: {key: law}), raising=False)
    monkeypatch.setitem(Feature.REGISTERED, key, make)
    return made


@pytest.mark.parametrize("room", [particles.ROOM, 0])
@pytest.mark.parametrize("law", ["local", "half-space"])
def test_how_often_hooks_are_asked(law: str, room: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of them exactly once a step, however full the table of pieces gets; the others as they say."""
    monkeypatch.setattr(particles, "ROOM", room)
    made = registered(monkeypatch, Witness)
    rows_of(law, "cpu")
    seen = made[-1].seen
    assert seen["end_step"] == STEPS
    assert seen["between"] >= STEPS
    parts = STEPS if law == "local" else seen["before_wear"]
    assert parts >= STEPS
    assert {seen[name] for name in ("before_wear", "after_wear", "after_part")} == {parts}


@pytest.mark.parametrize("case", ["track", "track, half-space"])
def test_features_know_what_part_of_the_stroke_their_disc_is(
    case: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = STUDIES[case]
    needs_transforms(study, "cpu")
    made = registered(monkeypatch, Witness)
    with Executor(study.cells, threads=1) as executor:
        model_of(study, executor)
    assert made[-1].site.track_fraction == study.track.track_fraction < 1.0


def test_an_array_is_declared_wherever_it_is_kept() -> None:
    with Executor(small("full").cells) as executor:
        field = executor.zeros()
        struct = arguments(Footprint, executor.device, bowl=3)
        for value in (field, {"of": field}, [(field,)], struct, np.zeros(3)):
            one = Feature()
            one.kept = value  # type: ignore[attr-defined]
            with pytest.raises(TypeError, match=r"^neither STATE nor SCRATCH of one has kept, which holds"):
                Features({"one": one})
        one.kept = [field]  # type: ignore[attr-defined]
        Features({"one": one}, bodies={"disc": field})
        one.kept = arguments(Curve, middle=1.0)  # type: ignore[attr-defined]
        Features({"one": one})


class Forgets(Debris):
    """Writes two columns, and declares fewer."""

    of_step = 0.0
    columns: ClassVar = ("debris",)

    def enter(self, columns: Any, total: Any, most: Any) -> None: ...


@pytest.mark.parametrize("law", ["local", "half-space"])
def test_columns_that_are_not_declared(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    attach(monkeypatch, Forgets)
    with pytest.raises(TypeError, match=r"^debris writes more columns of the history than it declares$"):
        rows_of(law, "cpu")
    monkeypatch.undo()
    attach(monkeypatch, type("Forgets", (Forgets,), {"columns": ()}))
    with pytest.raises(TypeError, match=r"^Forgets declares no columns of the history$"):
        rows_of(law, "cpu")


def test_what_makes_no_sense_is_refused() -> None:
    unsaid = type("Unsaid", (Feature,), {"columns": ("archard_volume_disc",)})()
    with pytest.raises(TypeError, match=r"^archard_volume_disc of one does not say of which body it is"):
        Features({"one": unsaid})
    again = type("Again", (Feature,), {"between": lambda self, program, place: None})()
    with pytest.raises(TypeError, match=r"^one has a hook `between`, .* and no `drain`: see `end_step`$"):
        Features({"one": again})


def test_a_column_that_no_step_fills_stops_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    of = Ledger._row

    def without(self: Ledger, *entry: Any) -> dict[str, Any]:
        return {name: value for name, value in of(self, *entry).items() if name != "patch_across"}

    monkeypatch.setattr(Ledger, "_row", without)
    with pytest.raises(InvariantError, match=r"^no step says what patch_across is after"):
        warpwear.run(small("full"))


def test_a_disc_that_is_raised_without_a_field_stops_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Exports of the track, of which the field is missing, would be another body."""
    attach(monkeypatch)
    with pytest.raises(
        InvariantError, match=r"^the disc is off its wear by \S+ mm after .* no field of a cell"
    ):
        warpwear.run(small("full", output__snapshots=[], sliding__distance="20 mm", wear__disc="0 mm^3/N/m"))


def test_fields_say_whether_the_disc_lies_lower_by_them_or_may_be_negative(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    marks = {"heap [mm, disc, raises]": {"meaning": "a height", "label": "heap", "map": True}}
    marks["turn [rad, contact, signed]"] = "an angle"
    own = {"cell, wear.dust_fraction": marks, "step, wear.sheds": {"piled [mm^3, disc]": "what is piled up"}}
    monkeypatch.setattr(Wear, "QUANTITIES", own, raising=False)
    heap, turn, piled = [*quantities._quantities()][-3:]
    assert (heap.lowers, heap.frame, heap.signed, heap.axis, heap.map) == (
        -1.0,
        "disc",
        False,
        "heap, mm",
        True,
    )
    assert (turn.lowers, turn.signed, piled.frame) == (0.0, True, "disc")
    study = small("full").replace(PARTICLES)
    assert (heap.applies_to(study), piled.applies_to(study)) == (False, True)
    assert heap.applies_to(study.replace({"wear.dust_fraction": 0.1}))
    assert heap.runs == "wear.dust_fraction"
    monkeypatch.setitem(quantities.FIELDS, "plastic_disc", heap)
    values = np.array([[0.1, 0.2]])
    assert (lowered({"plastic_disc": values}) == -values).all()  # type: ignore[operator]


def test_a_field_that_is_negative_and_does_not_say_so() -> None:
    fields = {"slip": np.array([1.0, -1.0]), "gap": np.array([-1.0])}
    found = [v.sentence for v in Invariants(small("full")).of_fields(fields, {"distance": 2.0})]
    assert found == ["slip is negative after 2 mm of sliding, and is not declared as signed"]


def test_fields_of_a_snapshot_are_declared_and_of_their_frame() -> None:
    fields = dict.fromkeys(("pressure", "wear_counter", "gap"), np.zeros((2, 3)))
    fields["wear_disc"] = np.zeros((4, 3))
    with pytest.raises(TypeError, match=r"^debris is not declared: see history/quantities.toml, \[cell\]$"):
        Snapshot.of(1.0, fields | {"debris": np.zeros((4, 3))})
    with pytest.raises(TypeError, match=r"^material_disc is of \(2, 3\) cells, where its frame has \(4"):
        Snapshot.of(1.0, fields | {"material_disc": np.zeros((2, 3))})
    assert Snapshot.of(1.0, fields).slip is None
    with pytest.raises(AttributeError):
        _ = Snapshot.of(1.0, fields).slips


def test_a_law_of_a_feature_scales_and_is_uniform_only_where_it_says_so() -> None:
    task = warpwear.Study.load("v3-fine").contact_task
    assert task.scales
    assert task.is_uniform
    law = replace(task, features={"heap": FeatureLaw()})
    assert not law.scales
    assert not law.is_uniform
    unsaid: Any = (0.1, 0.2)
    for value in (unsaid, 0.3, True):
        assert not replace(task, pieces=value).scales


def test_what_acts_in_each_step_does_not_go_with_jumps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where cycles jump by themselves each is computed then."""
    study = small("full", sliding__distance="20 m")
    assert study.jumps
    registered(monkeypatch, lambda _: Feature())
    assert not study.jumps
    with pytest.raises(InputError, match=r"^stepping.jump = 4 does not go with wear.disc, which acts in"):
        warpwear.run(small("full").replace({"stepping.jump": 4}))


class Pile(FeatureLaw):
    """Says that a volume is what both bodies have lost, and more."""

    def balances(self, row: Any) -> Any:
        yield "piled", row["wear_volume_disc"], 2.0 * row["wear_volume_disc"]


def test_laws_of_sections_have_a_feature_and_a_balance(monkeypatch: pytest.MonkeyPatch) -> None:
    made = registered(monkeypatch, lambda _: Feature(), Pile())
    with pytest.raises(InvariantError, match=r"^piled = \S+ mm³ after .*, where \S+ mm³ are due"):
        warpwear.run(small("full"))
    with pytest.raises(TypeError, match=r"^patches follow no wear.disc, and their keys do not say so$"):
        warpwear.run(STUDIES["patches"])
    made.clear()
    del Feature.REGISTERED["wear.disc"]
    with pytest.raises(TypeError, match=r"^no feature is called wear.disc$"):
        warpwear.run(small("full"))
    registered(monkeypatch, lambda _: Feature(), Pile(), "wear.dust_fraction")
    assert small("full", wear__dust_fraction=0.1).contact_task.features == {}  # it applies to particles alone
