"""List what one begins with: the studies with a name, and the materials."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from warpwear.results.frames import package
from warpwear.study import materials as table
from warpwear.study.loading import presets
from warpwear.study.study import Study


@dataclass(frozen=True, eq=False, repr=False)
class Catalogue:
    """A catalogue has entries by name; `print` shows them.

    Attributes
    ----------
    entries : dict
        Name -> the constants of a material, or name, description and model of a preset.
    text : str
        As it is printed.
    """

    entries: Mapping[str, Any]
    text: str

    def __repr__(self) -> str:
        return self.text

    def to_dataframe(self) -> Any:
        """Return the entries as a table.

        Returns
        -------
        pandas.DataFrame
            A row an entry.

        Raises
        ------
        InputError
            Where pandas is not installed.
        """
        return package("pandas", "to_dataframe").DataFrame([vars(one) for one in self.entries.values()])


def materials() -> Catalogue:
    """List the known materials, each with elastic constants, a hardness, and the source of each value.

    Returns
    -------
    Catalogue
        By name: condition, young [MPa], poisson, hardness [MPa], what it conducts, and sources.

    Examples
    --------
    >>> steel = warpwear.materials().entries["AISI 304"]
    >>> steel.young, steel.poisson
    (193000.0, 0.29)
    """
    known = {name: table.material(name) for name in table.names()}
    lines = []
    for each in known.values():
        lines.append(
            f"{each.name}, {each.condition}: E {1e-3 * each.young:g} GPa, ν {each.poisson:g}, "
            f"hardness {1e-3 * each.hardness:.3g} GPa"
        )
        for name, source in each.sources.items():
            value = f"{name} {getattr(each, name):g} {table.UNITS.get(name, '')}".rstrip()
            lines.append(f"    {value}: {source}")
    return Catalogue(known, "\n".join(lines))


def studies() -> Catalogue:
    """List the presets, which are studies with a name.

    Returns
    -------
    Catalogue
        Name, description and model of each; `Study.load` makes one.

    Examples
    --------
    >>> warpwear.studies().entries["track"].model
    'micro'
    """
    known = {name: Study.load(name).study for name in presets()}
    lines = [f"{name:<10} {about.description}" for name, about in known.items()]
    return Catalogue(known, "\n".join(lines))
