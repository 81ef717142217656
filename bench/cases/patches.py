"""A step of patches that tile the contact, beside the one-scale step on the same cells."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import Any

from contenders.baselines import Solved
from contenders.roster import Package, Setting, Trace, check, heights_of, study_on
from measure.timing import Row, Unit, measure, ratio_note

from warpwear import Study
from warpwear.engine.executor import Executor
from warpwear.laws.patches import Patches
from warpwear.models.patches.local import TwoScaleModel

EXTENT = 1.5  # [mm]: 30 macro cells of 50 µm
EARLY, LATE = [3.0e-3] * 10, [2400.0, 3.0, 3.0]  # steps before the timed ones [mm]


class Patched:
    """The package's two-scale step."""

    def __init__(self, study: Study, patches: Patches, executor: Executor) -> None:
        self._model = TwoScaleModel(study.contact_task, patches, heights_of(study), executor)

    def advance(self, increment: float) -> Solved:
        step = self._model.advance(increment, then=increment)
        row = step.row
        worn = row["wear_volume_counter"], row["wear_volume_disc"]
        return Solved(row["approach"], *worn, row["area_contact"], int(row["evaluations"]))


@contextmanager
def _models(study: Study, setting: Setting) -> Iterator[dict[str, Any]]:
    """One scale, patches without a bulk spring, patches with one, fresh."""
    threads = max(setting.threads)
    patches = study.patch_layout
    with ExitStack() as stack:
        whole, *parts = (
            stack.enter_context(Executor(grid, device=setting.device, threads=threads))
            for grid in (study.cells, patches.grid, patches.grid)
        )
        yield {
            "one scale": Package(study.replace({"study.model": "micro"}), heights_of(study), whole),
            "patches": Patched(study.replace({"patches.bulk": "none"}), patches, parts[0]),
            "patches on springs": Patched(study, patches, parts[1]),
        }


def patches(cells: int, setting: Setting) -> list[Row]:
    """900 patches of 50 µm beside the one-scale step, in turns; after 30 µm of sliding and after 2400 mm."""
    study = study_on(cells, preset="two-scale", extent=EXTENT)
    unit = Unit(cells)
    rows: list[Row] = []
    for when, before, increment in (("early", EARLY, 3.0e-3), ("late", LATE, 3.0)):
        with _models(study, setting) as models:
            traces: dict[str, Trace] = {
                name: [model.advance(d) for d in before] for name, model in models.items()
            }

            def step(name: str, models: dict[str, Any], traces: dict[str, Trace], increment: float) -> None:
                traces[name].append(models[name].advance(increment))

            times: dict[str, tuple[list[float], list[float]]] = {name: ([], []) for name in models}
            for repeat in range(1 + setting.repeats):
                for name in models:
                    taken = measure(partial(step, name, models, traces, increment), unit, 1, warm_ups=0)
                    for kept, new in zip(times[name], taken, strict=True):
                        kept.extend(new if repeat else [])
        check("patches", {name: traces[name] for name in ("one scale", "patches")})
        beside = Row("patches", cells, "", *times["one scale"])
        for name, taken in times.items():
            row = Row("patches", cells, "", *taken)
            note = f"{traces[name][-1].evaluations} evaluations"
            if name != "one scale":
                note += f"; {ratio_note('over one scale', row, beside)}"
            label = f"{when}: {name}, {max(setting.threads)} threads"
            rows.append(Row("patches", cells, label, *taken, note))
    return rows
