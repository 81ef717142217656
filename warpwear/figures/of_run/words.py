"""What is said of figures: when a run has no such figure, and why; and what their captions say of a run.

Each reason is a test of the run; its sentence for people stands in templates/sentences/reasons.toml.
Captions are templates, the starts of the docstrings of functions that declare figures; their fields are
filled in here.
"""

import inspect
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from warpwear.errors import prose
from warpwear.figures.describe import Figure
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.view import PASSES, last_at_hardness
from warpwear.figures.wording import listed
from warpwear.history.distances import with_unit
from warpwear.study.rules import FEWEST_ACROSS

#: What declares a figure of a run, and what says something of it.
Declare = Callable[[FigureData], Figure]
Say = Callable[[FigureData], str]
#: Name of a reason -> what is said of it.
SENTENCES = prose("reasons")
#: Pressures whose largest is less than this many times the mean are nearly the same.
EVEN = 1.1


class Reason(NamedTuple):
    """Why a figure is left out of the runs that the test picks. name: of its sentence."""

    name: str
    applies: Callable[[FigureData], bool]


def first_of(reasons: Iterable[Reason], data: FigureData) -> str | None:
    """Return the sentence of the first reason that applies to a run; None where none does."""
    return next((SENTENCES[reason.name] for reason in reasons if reason.applies(data)), None)


def _is_smooth(data: FigureData) -> bool:
    disc = data.study.disc.synthetic
    return data.study.study.model == "macro" or (disc is not None and disc.kind == "flat")


def _lost_nothing(*columns: str) -> Callable[[FigureData], bool]:
    """Test whether none of these columns of the history ends above zero."""
    return lambda data: not any(data.history[name][-1] > 0.0 for name in columns)


NO_COURSE = Reason("no_course", lambda d: d.steps < 2)
NO_COF = Reason("no_cof", lambda d: not np.isfinite(d.history["cof"]).any())
NO_FILM = Reason("no_film", lambda d: d.study.pair.film is None)
NO_LAYERS = Reason("no_layers", lambda d: not d.layered)
NO_TIME = Reason("no_time", lambda d: not np.isfinite(d.history["time"]).any())
NO_RADIUS = Reason("no_radius", lambda d: not all(d.study.counter.form.rises))
NO_STRESSES = Reason("no_stresses", lambda d: not d.study.has_stresses)
NO_SNAPSHOT = Reason("no_snapshot", lambda d: d.result.snapshot_distances.size == 0)
ONE_SNAPSHOT = Reason("one_snapshot", lambda d: d.result.snapshot_distances.size < 2)
SMOOTH_DISC = Reason("smooth_disc", _is_smooth)
SMOOTH = Reason("smooth", lambda d: _is_smooth(d) and not d.study.wear.sheds)
SQ = ("sq_counter", "sq_disc")
NO_TEXTURE = Reason("no_texture", lambda d: not any(np.isfinite(d.evolution.table[sq]).any() for sq in SQ))
NO_SPECTRUM = Reason("no_spectrum", lambda d: not all(d.spectra.values()))
ONLY_SAMPLES = Reason("only_samples", lambda d: d.study.samples_area)
ONE_SCALE = Reason("one_scale", lambda d: d.study.study.model != "two-scale")
ROUGH = Reason("rough", lambda d: d.study.study.model != "macro")
NO_HERTZ = Reason("no_hertz", lambda d: d.study.hertz is None)
NO_FACTOR = Reason("no_factor", lambda d: d.study.wear.distance_factor == "none")
NO_JUNCTIONS = Reason("no_junctions", lambda d: d.study.pair.critical_junction is None)
NO_PIECES = Reason("no_pieces", lambda d: not d.study.wear.sheds or d.result.pieces["step"].size < 2)
NO_FRETTING = Reason("no_fretting", lambda d: d.study.fretting is None)
ALL_SLIPS = Reason("all_slips", lambda d: not d.history["stick_area"].any())
NO_DRIVE = Reason("no_displacement", lambda d: not (d.study.fretting and d.study.fretting.has_displacement))
STILL = Reason("still", lambda d: not d.study.is_swept)
SWEPT = Reason("track", lambda d: d.study.is_swept)
SWEPT_FACTOR = Reason("track_factor", lambda d: d.study.is_swept)
UNWORN = Reason("unworn", _lost_nothing("wear_depth_counter", "wear_depth_disc"))
UNWORN_COUNTER = Reason("unworn_counter", _lost_nothing("wear_depth_counter"))
UNWORN_DISC = Reason("unworn_disc", _lost_nothing("wear_depth_disc"))
NO_GROOVE = Reason("no_groove", _lost_nothing("wear_depth_disc", "plastic_volume_disc"))
#: Reasons of several figures.
FIELD = (NO_SNAPSHOT, ONLY_SAMPLES)
NARROW = Reason("narrow", lambda d: d.study.cells.ny < FEWEST_ACROSS)
COUNTER_WORN = (*FIELD, UNWORN_COUNTER)
DISC_WORN = (SWEPT, *FIELD, UNWORN_DISC)
GROOVE = (STILL, NO_SNAPSHOT, NO_GROOVE)
PATCHES = (ONE_SCALE, NO_SNAPSHOT)
ROUGHNESS = (SWEPT, SMOOTH_DISC, ONE_SNAPSHOT, UNWORN_DISC)


class DeclaredFigure(NamedTuple):
    """A figure of a run: what declares it, and why a run may have none.

    essential: whether it goes into a paper, and is drawn by default. section: of the page that shows it.
    overlaid: columns of the history whose courses are laid over those of other runs.
    """

    declare: Declare
    reasons: tuple[Reason, ...]
    essential: bool
    section: str = ""
    overlaid: tuple[str, ...] = ()

    @property
    def template(self) -> str:
        """What stands below it, with fields of `FIELDS`: the start of what its function says of itself."""
        return " ".join((inspect.getdoc(self.declare) or "").partition("\n\n")[0].split())

    @property
    def help(self) -> str:
        """What the figure shows of any run."""
        return self.template.format_map(defaultdict(str, OF_ANY_RUN)).strip()

    def caption_of(self, data: FigureData) -> str:
        """Return what stands below it, of a run; the law of contact is said at the end."""
        return (self.template + " {law}").format_map(TemplateFields(data))


#: Figures of a run by name.
FIGURES: dict[str, DeclaredFigure] = {}
#: Fields of a caption that are filled in where no run is at hand.
OF_ANY_RUN = {"slider": "counter-body", "when": "at the snapshots", "end": "at the end", "groove": "groove"}
OF_ANY_RUN |= {"outline": "ellipse", "plane": "y = 0"}


def figure(*hidden_if: Reason, essential: bool = False, **others: Any) -> Callable[[Declare], Declare]:
    """Enter a function among the figures of a run; the start of its docstring is the caption.

    others: of `DeclaredFigure`; a section is one of templates/sentences/sections.toml.
    """

    def enter(declare: Declare) -> Declare:
        FIGURES[declare.__name__] = DeclaredFigure(declare, hidden_if, essential, **others)
        return declare

    return enter


class TemplateFields:
    """The fields of a template on a run, for its `format_map`: only those in the text are made.

    more: fields beside those of captions.
    """

    def __init__(self, data: FigureData, more: Mapping[str, Say] = MappingProxyType({})) -> None:
        self._data, self._says = data, {**FIELDS, **more}

    def __getitem__(self, name: str) -> str:
        return self._says[name](self._data)


def law_of(data: FigureData) -> str:
    """Say in a sentence by which law of contact a run found its pressures, with hardness, load and cells."""
    study = data.study
    if study.contact.law == "half-space":
        law = "Elastic half-space"
    elif study.study.model == "macro":
        law = f"Elastic foundation of {1e-6 * study.pair.bulk_stiffness:.3g}·10⁶ N/mm³"
    else:
        law = "Local law, cell by cell"
    patches = ", patches that share the load" if study.study.model == "two-scale" else ""
    cap = f", hardness {study.hardness:.3g} MPa" if np.isfinite(study.hardness) else ""
    loads = f"blocks of {study.programme}" if study.block else f"load {study.loads}"
    return f"{law}{patches}{cap}; {loads}; cells of {1e3 * study.grid.cell:.3g} µm."


def _when(data: FigureData) -> str:
    if [*data.distances] == [0.0]:
        return "without sliding"
    texts = [with_unit(distance, 4) for distance in data.distances]
    unit = texts[-1].partition(" ")[2]
    if all(text.endswith(f" {unit}") for text in texts):
        texts = [*(text.partition(" ")[0] for text in texts[:-1]), texts[-1]]
    return f"after {listed(texts)}"


def _end(data: FigureData) -> str:
    return data.after(data.distances[-1]) if data.distances[-1] else "without sliding"


def _friction(data: FigureData) -> str:
    friction = data.study.friction
    if friction.law != "shear-strength":
        return f"It is {data.shear}."
    area = {"contact": "in contact", "cumulative": "of a running sum of contacts"}
    sheared = f"The area {area.get(friction.area, friction.area)} shears"
    if friction.shear_strength is not None:
        return f"{sheared}; {data.shear}."
    place = "end" if friction.calibrate == "end" else "start"
    return (
        f"{sheared}; its shear strength is {data.shear}, so that the value at the {place} (circle) is an "
        "input and only the course is a result."
    )


def _passes(data: FigureData) -> str:
    """Say what thin and bold lines are, where there are both."""
    if data.study.lap is None or data.study.passes_at(data.course["distance"][-1]) + 1e-9 < PASSES:
        return ""
    return " Thin: steps; bold: from the middle of the first pass on the mean of each pass."


def _fall(data: FigureData) -> str:
    """Say why the largest pressure falls, where it does."""
    course = data.course
    row = last_at_hardness(course)
    if row is None:
        return ""
    ratio = course["pressure_max"][row + 2 :] / course["pressure_mean"][row + 2 :]
    then = ""
    if ratio.size:
        most = float(ratio.max())
        then = "nearly the same in all cells" if most < EVEN else f"at most {most:.2g} times the mean"
        then = f"; from then on the pressure is {then}"
    return (
        f" The largest pressure falls where wear has taken down the last asperity at the hardness, after "
        f"{course['distance'][row]:.3g} mm{then}."
    )


def _blocks(data: FigureData) -> str:
    n = data.window.factor
    return f" A point is {n} × {n} cells and shows the largest of them." if n > 1 else ""


def _critical(data: FigureData) -> str:
    """Say what d* is, where the study has one."""
    study = data.study
    if study.pair.critical_diameter is None:
        return ""
    what = "the pieces' diameter" if study.wear.sheds else "the critical diameter of junctions"
    return f" Dots: the share above {what}, d* = {1e3 * study.pair.critical_diameter:.3g} µm."


def _smooth(data: FigureData) -> str:
    """Say what stands below the loads of patches, where anything does."""
    if len(data.loads.of) < 2:
        return ""
    if data.loads.prescribed:
        return "; below, a smooth contact, which prescribes them"
    return (
        "; below, those of a smooth contact with a wear of its own, and the part of the load that it puts on "
        "other patches"
    )


#: Field of a caption -> what it says of a run.
FIELDS: dict[str, Say] = {
    "slider": lambda d: d.slider,
    "outline": lambda d: "rectangle" if d.study.counter.form.is_line else "ellipse",
    "when": _when,
    "end": _end,
    "friction": _friction,
    "passes": _passes,
    "fall": _fall,
    "blocks": _blocks,
    "critical": _critical,
    "smooth": _smooth,
    "deepest": lambda d: _blocks(d).replace("largest", "deepest"),
    "groove": lambda d: d.groove,
    "plane": lambda d: d.study.output.stress_plane,
    "law": law_of,
}
