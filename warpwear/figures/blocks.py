"""Charts over the sliding distance show the borders of a programme's blocks."""

from dataclasses import replace

from warpwear.figures.describe import DISTANCE, NOMINAL, Chart, Figure, Level, Look, Panel
from warpwear.figures.wording import listed
from warpwear.study.study import Study


def with_blocks(figure: Figure, study: Study) -> Figure:
    """Draw where the blocks of a programme begin in the charts over the distance, and say what they are."""
    ends = [block.end for block in study.blocks[:-1]]
    borders = [Level(end, look=Look(NOMINAL, "dot", 0.8), axis="x") for end in ends]

    radii = listed([f"{radius:.4g}" for radius in study.circles]) if study.circles else ""
    what = f"dotted: blocks of {study.loads}" + (f", on tracks of {radii} mm radius" if radii else "")

    def bordered(panel: Panel) -> Panel:
        if not isinstance(panel, Chart) or panel.x.label != DISTANCE:
            return panel
        note = "\n".join(filter(None, (panel.note, what)))
        return replace(panel, lines=[*panel.lines, *borders], note=note)

    if study.block is None:
        return figure
    return replace(figure, panels=[bordered(panel) for panel in figure.panels])
