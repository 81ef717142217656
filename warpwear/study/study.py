"""A study: what to compute, read from TOML, checked, frozen."""

from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path
from typing import Any, Self

from pydantic import ValidationError, model_validator

from warpwear.errors import InputError
from warpwear.study import doubts, loading, rules, text
from warpwear.study.content import Content
from warpwear.study.keys import dotted, value_of
from warpwear.study.resolve import resolve

#: Between a description and the keys changed since it was written.
CHANGED = "; changed: "
#: Sections of whose changes a description does not speak: names, checks, and what is written.
NOT_DESCRIBED = ("study", "checks", "output", "assumed")


class Study(Content):
    """A study is its sections of keys (see `warpwear.study.movement`), each number in mm, N, MPa or s.

    Make one with `Study.load(path_or_preset)` or from sections: `Study(counter={"radius": "3 mm"}, ...)`.
    A study is frozen, and `replace` gives a changed copy.

    Parameters
    ----------
    **sections
        By their names, each with its keys as docs/reference/keys.md has them. Quantities are text, pairs such
        as ``(3, "mm")``, or pint's.

    Raises
    ------
    InputError
        For anything that cannot be computed, with one sentence.
    """

    def __init__(self, **sections: Any) -> None:
        flat = dotted(sections | {"assumed": None}) | {"assumed": sections.get("assumed", {})}
        sections = loading.nested(flat)
        names = loading.fill(sections)
        try:
            super().__init__(**sections)
        except ValidationError as error:
            raise InputError(text.sentence(error, type(self))) from None
        for name in names:  # so that they are told from what was given
            section, _, key = name.partition(".")
            getattr(self, section).model_fields_set.discard(key)

    @model_validator(mode="before")
    @classmethod
    def _resolved(cls, sections: dict[str, Any]) -> dict[str, Any]:
        """Fill in what sections say only together; their own validation comes first."""
        written = Content(**sections)
        content = resolve(written)
        return {name: getattr(content, name) for name in written.model_fields_set}

    def _check(self) -> None:
        rules.check(self)

    def __eq__(self, other: object) -> bool:
        """Two studies are equal where their resolved texts are: what they compute, assume and are called."""
        return self.to_toml() == other.to_toml() if isinstance(other, Study) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __repr__(self) -> str:
        about, cells = self.study, self.cells
        return (
            f"<Study '{about.name}': {about.model} model, {self.contact.law} law, {self.kinematics}, "
            f"{cells.nx} × {cells.ny} cells of {1e3 * cells.cell:g} µm, {self.loads} over "
            f"{self.sliding.total:g} mm>"
        )

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """Return a notebook's view of the study: its keys, with the assumptions marked."""
        return f"<div>{escape(repr(self))}<pre>{escape(self.to_toml(marked=True))}</pre></div>"

    def _refuse_blocks(self, what: str) -> None:
        """Raise InputError for a programme of blocks, in the name of what goes by one load alone."""
        if self.block is not None:
            raise InputError(f"{what} goes by one load: [[block]], a programme, is not allowed")

    def notices(self) -> list[str]:
        """Say what misleads.

        Returns
        -------
        list of str
            A sentence about each unused key, and each number that misleads.
        """
        total = self.sliding.total
        sentences = list(doubts.doubts(self))
        late = ", ".join(f"{s:g}" for s in self.snapshot_distances if s > total or s == 0.0 < total)
        if late:
            sentences.append(f"output.snapshots that no step ends at: {late} mm.")
        return sentences

    def to_toml(self, *, marked: bool = False) -> str:
        """Write the whole study after defaults, as TOML that `load` reads back without loss.

        Parameters
        ----------
        marked : bool
            Whether for people instead, with defaults marked and the reasons of what is assumed.

        Returns
        -------
        str
            The text.
        """
        if marked:
            return text.to_marked_toml(self.used_keys, self.assumptions, self.given_keys)
        left_open = self.resolved  # stays so: it follows from the others, also when those are changed later
        keys = {name: value for name, value in self.used_keys.items() if name not in left_open}
        return text.to_toml(keys, self.assumptions)

    @classmethod
    def load(cls, path_or_preset: str | Path) -> Self:
        """Read the study in a TOML file or a run folder, or the preset of that name.

        Parameters
        ----------
        path_or_preset : path or str
            `studies` lists the presets.

        Returns
        -------
        Study
            With its defaults.

        Raises
        ------
        InputError
            For what is no study, or one that cannot be computed.
        """
        sections = loading.read_sections(path_or_preset)
        if "sweep" in sections:
            raise InputError(f"STUDY = '{path_or_preset}' has a section [sweep]; 'warpwear sweep' makes it.")
        return cls(**sections)

    @classmethod
    def stored(cls, content: str, *, surface: str | None = None) -> Self:
        """Return the study in the text of a stored result.

        surface: file of the disc's heights where that has moved since; without it the one in the text.
        """
        sections = loading.parse_toml(content)
        if surface is not None:
            sections["disc"]["surface"] = surface
        return cls(**sections)

    def replace(self, changes: Mapping[str, Any] | None = None, /, **sections: Any) -> Self:
        """Return a copy with keys changed: {"grid.cell": "2 um"}, or by section: grid={"cell": "2 um"}.

        A key that says the same in another way is dropped: a new counter.diameter replaces counter.radius.
        The description tells what has changed, unless it is set itself.

        Parameters
        ----------
        changes : dict, optional
            Key with dots -> new value; of wear.counter or wear.disc a WearCalibration, too: its mean with the
            unit.
        **sections
            Section -> its keys that change.

        Returns
        -------
        Study
            The copy.

        Raises
        ------
        InputError
            For anything that cannot be computed.

        Examples
        --------
        >>> study = warpwear.Study.load("v3-fine").replace({"contact.load": "4 N", "grid.cell": "2 um"})
        >>> study.contact.load, study.grid.cell
        (4.0, 0.002)
        >>> study.replace({"contact.load": "4 mm"})
        Traceback (most recent call last):
        warpwear.errors.InputError: contact.load = '4 mm': has the wrong dimension: a force ... length...
        """
        if not isinstance(changes or {}, Mapping) or not all(isinstance(name, str) for name in changes or ()):
            raise InputError(f"{changes!r} is no change of a study; write {{'contact.load': '4 N'}}.")
        flat = dict(changes or {})
        for section, keys in sections.items():
            of_section = isinstance(keys, Mapping)
            flat |= {f"{section}.{k}": v for k, v in keys.items()} if of_section else {section: keys}
        if not flat:
            return self  # it is frozen
        nested = self.model_dump(exclude_unset=True)
        loading.change(nested, flat)
        changed_study = type(self)(**nested)
        if not self.study.description or "study.description" in flat:
            return changed_study
        about = changed_study.study.model_copy(update={"description": self._changed(changed_study, flat)})
        return changed_study.model_copy(update={"study": about})

    def _changed(self, after: "Study", names: Iterable[str]) -> str:
        """Return the description followed by the keys changed since, those that it names included.

        names: dotted, of the keys that were given anew.
        """
        about, _, listed = self.study.description.partition(CHANGED)
        was, now = self.model_dump(), after.model_dump()
        changed = [name for name in names if value_of(was, name) != value_of(now, name)]
        changed = [n for n in changed if n == "study.model" or n.partition(".")[0] not in NOT_DESCRIBED]
        listing = dict.fromkeys([*filter(None, listed.split(", ")), *changed])
        return f"{about}{CHANGED}{', '.join(listing)}" if listing else about
