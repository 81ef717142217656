"""What misleads of a run that goes on, in sentences that become its warnings."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from warpwear.grid import FloatArray
from warpwear.laws.elastic import FLOW, asperities
from warpwear.laws.track import is_whole
from warpwear.results.track import doubt_of_directions
from warpwear.study.doubts import say
from warpwear.study.study import Study

#: A coefficient of friction beyond this is a mistake, not a result.
ABSURD_COEFFICIENT = 3.0
#: A step on the half-space whose length changes the area by more, relatively, is told of.
AREA_ERROR = 0.1
#: A contact of fewer cells is not resolved.
FEW_CELLS = 20
#: Cells of a row of a line contact that a contact needs as much.
LEAST_IN_A_ROW = 5
#: Fewer cells do not even tell by how much.
COUNTED_CELLS = 4


def of_slope(study: Study, slope: float) -> Iterator[str]:
    """Doubt a disc of this rms slope whose asperities yield before they flow, by the local law."""
    modulus = study.pair.effective_modulus
    local = study.study.model == "micro" and study.contact.law == "local" and study.is_rough
    if not local or study.hardness is None or study.contact_task.compliance > 0.0:
        return
    ratio, kind = asperities(study.hardness, modulus, slope)
    if ratio <= FLOW:
        return
    sentence = f"H/(E*·rms slope) is {ratio:.2g}"
    if modulus is None:
        sentence = f"{sentence} for two bodies of steel (young or poisson of one is not given)"
    yield say("high_asperities", kind=kind, sentence=sentence, flow=FLOW)


def of_count(study: Study, count: float, when: str) -> Iterator[str]:
    """Doubt a contact of too few cells, and name the size that would do. when: opens the sentence."""
    if count >= FEW_CELLS or (study.is_line and count >= LEAST_IN_A_ROW * study.cells.ny):
        return
    area = max(count, 1.0) * study.cells.cell_area
    if count < COUNTED_CELLS:  # which say little of an area, that the load and the hardness bound
        area = min(area, study.blocks[0].load / study.hardness or area)
    enough = 1.0e3 * math.sqrt(area / FEW_CELLS)
    digit = 10.0 ** (math.floor(math.log10(enough)) - 1)
    sizes = [1.0e-3 * n * digit for n in range(math.floor(enough / digit), 0, -1)]
    whole = (size for size in sizes if all(is_whole(side / size) for side in study.grid.sides))
    are, cell = "cell is" if count == 1.0 else "cells are", 1e3 * study.grid.cell
    needed = 1e3 * next(whole, sizes[0])
    yield say("few_cells", when=when, count=count, are=are, cell=cell, needed=needed, few=FEW_CELLS)


def of_history(study: Study, history: Mapping[str, FloatArray], *, finished: bool) -> Iterator[str]:
    """Doubt a history whose friction, lengths of steps or numbers of cells no contact has."""
    highest = history["cof"].max()
    if highest > ABSURD_COEFFICIENT:
        yield say("absurd_friction", highest=highest, study=study)
    long = int(np.count_nonzero(history.get("area_error", np.zeros(1)) > AREA_ERROR))
    if long:
        yield say("long_parts", long=long, percent=100.0 * AREA_ERROR)
    if doubt := doubt_of_directions(study, history):
        yield doubt
    friction, limit = study.friction, study.pair.shear_limit
    tau = friction.law_with().final_strength(
        history, load=history["load"], finished=finished, laps=study.laps
    )
    film = friction.film.shear_strength if friction.film else 0.0
    for name, strength in (("shear strength", tau), ("shear strength of the film", film)):
        if strength > limit:
            yield say("beyond_shear", name=name, strength=strength, friction=friction, limit=limit)
    cells = history["cells_in_contact"]
    if cells[0] >= FEW_CELLS:
        yield from of_count(study, cells.min(), "At times")


def smaller_steps(study: Study) -> str:
    """Advise on a contact that could not be balanced; empty where the same step would not come again."""
    if study.is_swept or not study.sliding.total:
        return ""
    return " A new run may get further with smaller increments ([stepping])."
