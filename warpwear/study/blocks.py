"""[[block]]: the blocks of a programme, and the study that each of them is by itself."""

from typing import TYPE_CHECKING, Annotated, TypeVar

from pydantic import Field

from warpwear.laws.blocks import Block
from warpwear.study.keys import Length, Section, key
from warpwear.study.units import Number, Quantity

if TYPE_CHECKING:
    from warpwear.study.content import Content

Whole = TypeVar("Whole", bound="Content")
Count = Annotated[int, Field(ge=1, le=1_000_000_000, strict=True)]
#: Keys that say one thing: what a block says takes the place of all that [sliding] says of it.
LENGTHS = ("distance", "passes", "cycles", "revolutions", "duration")
PACES = ("speed", "frequency")


class BlockSection(Section):
    """A table [[block]] says what differs in it from [contact] and [sliding], and how far it slides."""

    load: Annotated[float, Quantity("N")] | None = key(None, "normal load in the block")
    speed: Annotated[float, Quantity("mm/s")] | None = key(None, "sliding speed, for the time axis only")
    frequency: Annotated[float, Quantity("Hz")] | None = key(
        None, "cycles, or with a track_radius revolutions, in a second"
    )
    distance: Length | None = key(None, "sliding distance of the block; or one of the next four")
    passes: Count | None = key(None, "number of strokes")
    cycles: Count | None = key(None, "number of pairs of strokes")
    revolutions: Annotated[float, Number()] | None = key(None, "revolutions of a rotating disc")
    duration: Annotated[float, Quantity("s")] | None = key(None, "with a frequency: time of the block")


def part_of(study: Whole, block: BlockSection) -> Whole:
    """Return the study that a block of a programme is by itself, unchecked."""
    own = {name: value for name in type(block).model_fields if (value := getattr(block, name)) is not None}
    contact = study.contact.model_copy(update={"load": own.pop("load", study.contact.load)})
    ways = (*LENGTHS, *(PACES if own.keys() & set(PACES) else ()))
    sliding = study.sliding.model_copy(update=dict.fromkeys(ways) | own)
    return study.model_copy(update={"block": None, "contact": contact, "sliding": sliding})


def in_a_row(parts: "tuple[Content, ...]") -> tuple[Block, ...]:
    """Return the blocks of studies one after another."""
    blocks: list[Block] = []
    start, since = 0.0, (0.0, 0.0)
    for number, part in enumerate(parts, 1):
        speed, end = part.sliding.mean_speed, start + part.sliding.total
        if blocks and speed != blocks[-1].speed:
            since = start, blocks[-1].time(start)
        blocks.append(Block(number, start, end, part.contact.load, speed, since))
        start = end
    return tuple(blocks)
