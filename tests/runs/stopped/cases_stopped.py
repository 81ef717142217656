"""What tests of runs that were stopped share: a short study, and how a run of it is stopped."""

import math
import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import warpwear
from warpwear import Study
from warpwear.models.patches.half_space import HalfSpacePatches
from warpwear.models.patches.local import TwoScaleModel
from warpwear.models.rest.local import OneScaleModel
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.models.track.local import SlidingContact
from warpwear.runs.checkpoint import FILE_NAME, Checkpoints

ROOT = Path(__file__).parents[3]
KILLS = ROOT / "bench" / "kills.py"
of_kills = runpy.run_path(str(KILLS))
CASES, differences, study_of = of_kills["CASES"], of_kills["differences"], of_kills["study_of"]
#: Cases whose state others have, too: quick tests do not stop them.
COVERED = ("micro, implicit", "micro, many tiles", "bearing area", "two-scale, load")


#: What makes a step of a model that lies still, or of a contact that slides.
MODELS = (OneScaleModel, TwoScaleModel, HalfSpacePatches)
ADVANCE: dict[tuple[Any, str], Callable[..., Any]] = {(model, "advance"): model.advance for model in MODELS}
ADVANCE |= {
    (SlidingContact, "step"): SlidingContact.step,
    (SlidingHalfSpace, "slide"): SlidingHalfSpace.slide,
}

#: Changes of a study on springs.
HALF_SPACE = {"contact.law": "half-space", "counter.radius": "3 mm"}

SHORT = {"sliding.distance": "0.2 mm", "output.snapshots": ["0.05 mm"]}


def short(**changes: Any) -> Study:
    """A study of 43 steps."""
    dotted = {k.replace("__", "."): v for k, v in changes.items()}
    return study_of("micro, implicit", math.inf).replace(SHORT | dotted)


def at_step(monkeypatch: pytest.MonkeyPatch, after: int, how: Callable[[Any], object]) -> list[int]:
    """Let something happen to the model in the step after so many; return a list that grows by each."""
    calls: list[int] = []
    for model in (OneScaleModel, TwoScaleModel, SlidingContact):
        monkeypatch.setattr(model, "in_blocks", False)  # a call is a step

    def disturbed(advance: Callable[..., Any]) -> Callable[..., Any]:
        def step(model: Any, *args: Any, **kwargs: Any) -> Any:
            calls.append(1)
            if len(calls) == after + 1:
                how(model)
            return advance(model, *args, **kwargs)

        return step

    for (model, name), advance in ADVANCE.items():
        monkeypatch.setattr(model, name, disturbed(advance))
    return calls


def stop(monkeypatch: pytest.MonkeyPatch, after: int, how: Callable[[], object]) -> None:
    """Let something happen in the step after so many, counted from here."""
    at_step(monkeypatch, after, lambda _: how())


def killed() -> None:
    raise SystemExit("killed")


def run_stopped(study: Study, out: Path, after: int, **options: Any) -> None:
    """Leaves the checkpoint of so many steps, with one after each of the last three; after all where some are
    made again, as with jumps and where the length of parts is measured.
    """
    with pytest.MonkeyPatch.context() as patch:
        calls = at_step(patch, after, lambda _: killed())
        again = study.jumps or (study.is_swept and study.contact.law == "half-space")
        patch.setattr(Checkpoints, "due", property(lambda _: again or len(calls) > after - 3))
        with pytest.raises(SystemExit):
            warpwear.run(study, out=out, plots=False, **options)
    assert (out / FILE_NAME).is_file()


def soon_done(case: str) -> Study:
    """A case of the kills with few steps, without checkpoints."""
    study: Study = study_of(case, math.inf).replace({"output.snapshots": ["0.06 mm"]})
    if case == "programme, swept, stresses":
        return study.replace({"sliding.shift": 8})
    if case.startswith("fretting"):
        return study.replace({"sliding.cycles": 100 if "gross" in case else 3_000})
    if case.endswith("jumps"):
        return study.replace({"sliding.distance": "24 mm"})
    small_steps = case.startswith(("micro", "two-scale", "half-space", "stresses"))
    return study.replace({"sliding.distance": "0.2 mm" if small_steps else "3 mm"})
