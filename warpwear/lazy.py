"""Imports put off until they are needed, so that `import warpwear` and `warpwear --help` stay quick.

Internal names that are looked up late stand in tables: `warpwear.__init__`, `warpwear.cli.places`,
`warpwear.result` and `warpwear.runs.arrangements`. What else is late, of other packages or for GPUs and
figures, is a `module` at the top of the file that needs it.
"""

import gc
import sys
from importlib import import_module
from typing import Any

#: Modules by name, once they are imported whole: an inner loop that asks for one need not look for it.
_LOADED: dict[str, Any] = {}


def resolve(place: str) -> Any:
    """Return the object at a place, such as "warpwear.study.study:Study", whose module is imported now."""
    name, _, attribute = place.partition(":")
    return getattr(load(name), attribute)


def load(name: str) -> Any:
    """Return a module, imported now. Raises ImportError where it is of a package that is not installed.

    Nothing of what an import makes is garbage: looking for some meanwhile takes a seventh of its time.
    """
    loaded = _LOADED.get(name)
    if loaded is None or sys.modules.get(name) is not loaded:
        collects = gc.isenabled()
        gc.disable()
        try:
            loaded = _LOADED[name] = import_module(name)
        finally:
            if collects:
                gc.enable()
    return loaded


class module:
    """A module that is imported when something of it is first asked for.

    Asking raises ImportError where it is not installed.
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        return getattr(load(self._name), attribute)
