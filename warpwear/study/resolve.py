"""What sections of a study say only together is filled in, before the study is made."""

import re
from itertools import pairwise
from typing import Any

from warpwear.laws.track import WHOLE, is_whole
from warpwear.study.content import Content
from warpwear.study.keys import refused
from warpwear.study.motion import LENGTHS, WAYS, BlockSection, Sliding
from warpwear.study.rules import check
from warpwear.study.units import LineLoad

#: Most blocks of a programme: more than anybody writes, and seconds to read.
MOST_BLOCKS = 10_000


def resolve(written: Content) -> Content:
    """Return what a user wrote, each section by itself, with what sections say only together.

    A load of a length is that of the whole domain. A force gets the stroke of the unworn bodies, by which
    distances count, and [sliding] the distance and the pass of the blocks. Raises ValueError.
    """
    across = written.grid.sides[1]
    whole: dict[str, Any] = {"contact": _whole(written.contact, across)}
    if written.block is not None:
        whole["block"] = tuple(_whole(block, across) for block in written.block)
    content = written.model_copy(update=whole)
    force, pair = content.sliding.force, content.pair
    if force is not None and pair.effective_modulus is not None and content.counter.has_hertz:
        moved = content.sliding.model_copy()
        moved._travel = 2.0 * pair.displacement(force)
        content = content.model_copy(update={"sliding": moved})
    if content.block is not None:
        content = content.model_copy(update={"sliding": _sliding_of_blocks(content)})
    return content


def _whole(section: Any, across: float) -> Any:
    """Return a section whose load, where it is one of a length, is that of the whole domain [mm]."""
    if not isinstance(section.load, LineLoad):
        return section
    return section.model_copy(update={"load": LineLoad(section.load.per_length, across)})


def _sliding_of_blocks(study: Content) -> Sliding:
    """Return [sliding] with the distance and the pass that blocks make together: raises ValueError."""
    for name in LENGTHS:
        if getattr(study.sliding, name) is not None:
            raise refused("lengths_of_blocks", name=name)
    if not study.block:
        raise refused("no_block")
    first = study.parts[0]
    if len(study.block) > MOST_BLOCKS:
        raise refused("many_blocks", count=len(study.block), most=MOST_BLOCKS)
    for number, part in study.telling_parts:
        try:
            check(part)
        except ValueError as error:
            here = re.sub(
                rf"(contact\.|sliding\.)({'|'.join(BlockSection.model_fields)})\b", r"\2", str(error)
            )
            raise ValueError(f"block {number}: {here}") from error
        moves = [(one.is_swept, one.sliding.track_radius is None) for one in (part, first)]
        if any(swept for swept, _ in moves) and moves[0] != moves[1]:
            raise refused("unlike_blocks", number=number)
    _circles(study)
    laps = {block.lap for block in study.blocks}
    for block, after in pairwise(study.blocks):
        turns = block.lap != after.lap and not study.circles  # another stroke begins where the last one began
        if first.is_swept and not is_whole(block.length / (block.lap or 1.0) / (2 if turns else 1)):
            other = "stroke" if turns else "block"
            raise refused("part_of_a_pass", block=block, pairs="pairs of " * turns, other=other)
    follows = {"distance": study.blocks[-1].end}
    if study.sliding.lap is None or (first.is_swept and len(laps) == 1):  # what all blocks have in common
        ways = {name: getattr(first.sliding, name) for name in WAYS}
        follows |= {name: value for name, value in ways.items() if value != getattr(study.sliding, name)}
    sliding = study.sliding.model_copy(update=follows)
    sliding.model_fields_set.difference_update(follows)
    return sliding


def _circles(study: Content) -> None:
    """Refuse circles of a disc so close that the contact on one would reach another."""
    wide = study.grid.sides[1]
    for radius, other in pairwise(sorted(study.circles)):
        if study.is_line or other - radius < wide * (1.0 - WHOLE):
            raise refused("close_circles", radius=radius, other=other, wide=wide)
