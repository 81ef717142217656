"""Lay figures under the headings of a page."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from warpwear.figures.describe import Figure


@dataclass(frozen=True)
class PageSection:
    """Hold figures by name under one heading of a page. one_legend: of all lines."""

    title: str
    figures: dict[str, Figure]
    id: str = ""
    text: str = ""
    one_legend: bool = False


def under_headings(
    figures: Mapping[str, Figure],
    layout: Iterable[tuple[str, str, Sequence[str], str]],
    *,
    one_legend: Sequence[str] = (),
    fields: Any = MappingProxyType({}),
) -> list[PageSection]:
    """Lay figures under the headings of a page, each with its anchor, names of figures and what is said.

    one_legend: anchors of sections with one legend. fields: of headings and texts, by name. A heading without
    a figure is left out.
    """
    return [
        PageSection(title.format_map(fields), some, anchor, text.format_map(fields), anchor in one_legend)
        for title, anchor, names, text in layout
        if (some := {name: figures[name] for name in names if name in figures})
    ]
