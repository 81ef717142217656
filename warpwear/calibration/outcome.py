"""Every calibration returns one of these, which commands print."""

from dataclasses import dataclass
from html import escape
from typing import Any

from warpwear.results.frames import package
from warpwear.results.report import Row, lines, record, without_nan


@dataclass(frozen=True, kw_only=True, repr=False)
class Calibration:
    """Hold what a calibration came to: print it, or take its numbers by name.

    `print` shows it for people, `to_dict` gives its numbers by the names that `--json` prints, and
    `to_dataframe` its rows.
    """

    def _title(self) -> str:
        """Say in a line what was found."""
        raise NotImplementedError

    def _rows(self) -> list[Row]:
        """Declare all numbers, as they are printed."""
        raise NotImplementedError

    def _table(self) -> list[list[Row]]:
        """Declare the rows of the table, by default one with all numbers."""
        return [self._rows()]

    def __repr__(self) -> str:
        return f"<{self._title()}>"

    def __str__(self) -> str:
        return "\n".join([self._title(), *lines(self._rows())])

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"

    def to_dict(self) -> dict[str, Any]:
        """Return all numbers by their names, which end in their unit.

        Returns
        -------
        dict
            The same names and numbers as the command prints with ``--json``.
        """
        return dict(without_nan(record(self._rows())))

    def to_dataframe(self) -> Any:
        """Return the rows of the table as a ``pandas.DataFrame``.

        Returns
        -------
        pandas.DataFrame
            A row a test, an area or a speed; without such a single row with all numbers.

        Raises
        ------
        InputError
            Where pandas is not installed.
        """
        return package("pandas", "to_dataframe").json_normalize([record(row) for row in self._table()])
