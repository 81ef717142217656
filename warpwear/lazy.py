"""Imports put off until they are needed, so that `import warpwear` and `warpwear --help` stay quick.

Internal names that are looked up late stand in three tables: `warpwear.__init__`, `warpwear.cli.places` and
`warpwear.result`. What other packages give late is a `module` at the top of the file that needs it.
"""

from importlib import import_module
from typing import Any


def resolve(place: str) -> Any:
    """The object at a place, such as "warpwear.study.study:Study", whose module is imported only now."""
    name, _, attribute = place.partition(":")
    return getattr(import_module(name), attribute)


def load(name: str) -> Any:
    """A module of another package, imported now. Raises ImportError where it is not installed."""
    return import_module(name)


class module:
    """A module of another package that is imported when something of it is first asked for.

    Asking raises ImportError where it is not installed.
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        return getattr(import_module(self._name), attribute)
