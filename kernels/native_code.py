"""C++ of kernels is headers in `native/`, which stand before the code that Warp makes of a module.

A native function of a module is a line that calls what a header defines. Headers are templates, as the
structs of a module come after them, and text of the module: a header that changes is compiled anew.
"""

import inspect
import re
from collections.abc import Callable
from functools import cache, partial
from hashlib import blake2b
from pathlib import Path
from typing import Any

import warp as wp

from warpwear.kernels.cells import TABLES

FOLDER = Path(__file__).with_name("native")
#: A line of a header that names another one, which comes before it.
INCLUDE = re.compile(r'^#include "(.+)"$', re.MULTILINE)

#: The lines of tables of partial results, by the names of Python, and how many there are.
LINES = "".join(f"enum class {t.__name__} {{ {', '.join(t.__members__)}, LINES }};\n" for t in TABLES)
#: Kernels that take the first and the end of a range of slots.
RANGED: set[Any] = set()
#: Headers of a preamble, by its text.
_HEADERS: dict[str, list[str]] = {}


def options(*headers: str) -> dict[str, Any]:
    """Return the options of a module whose native functions call these headers, or `lanes.h` alone."""
    names = dict.fromkeys(name for header in headers or ("lanes.h",) for name in _with_includes(header))
    text = LINES + "".join(_text(name) for name in names)
    _HEADERS[text] = list(names)
    build = wp.ModuleBuildOptions(extra_cpu_preamble=text, extra_cuda_preamble=text)
    return {"enable_backward": False, "extra_build_options": build}


def passes_of(name: str, *headers: str, **more: Any) -> Callable[..., Any]:
    """Return what makes passes of a module of Warp's, see `native_pass`, whose options are those of headers.

    more: other options.
    """
    module = wp.get_module(name)
    wp.set_module_options(options(*headers) | more, module=module)
    return partial(native_pass, module)


@cache
def together(kernels: tuple[Any, ...]) -> dict[Any, Any]:
    """Copy kernels into a module of their own, which pays for Warp's headers once; return the copy of each.

    Their modules have no other options than those of `options`.
    """
    of_each = [kernel.module.options["extra_build_options"].extra_cpu_preamble for kernel in kernels]
    names = ",".join(f"{kernel.module.name}.{kernel.key}" for kernel in kernels)
    module = wp.get_module(f"{kernels[0].module.name}.{blake2b(names.encode(), digest_size=4).hexdigest()}")
    headers = dict.fromkeys(header for text in of_each for header in _HEADERS[text])
    wp.set_module_options(options(*headers), module=module)
    copies = {
        kernel: wp.Kernel(kernel.func, key=kernel.key, module=module, source=kernel.adj.source)
        for kernel in kernels
    }
    RANGED.update(copy for kernel, copy in copies.items() if kernel in RANGED)
    return copies


def native_pass(module: Any, function: str, *, name: str = "", **arguments: Any) -> Any:
    """Make a kernel of a module that calls a C++ function of its headers for each of its slots.

    arguments: types of those after the slot and the number of slots, by name. Before them the kernel takes
    the first and the end of a range of slots, and their number: on a CPU one call of it does a range, so that
    its arguments are read once. name: of the kernel, by default that of the function.
    """
    name = re.sub(r"\W", "_", name or function)
    types = dict.fromkeys(("first", "end", "slots"), wp.int32) | arguments
    call = f"{function}(slot, {', '.join([*types][2:])});"

    def slots_of_range() -> None: ...

    def kernel() -> Any:
        return native  # where Warp looks up the name

    for stub in (slots_of_range, kernel):
        stub.__name__ = stub.__qualname__ = name
        stub.__module__, stub.__annotations__ = module.name, types
        stub.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [inspect.Parameter(key, inspect.Parameter.POSITIONAL_OR_KEYWORD) for key in types]
        )
    native = wp.func_native(f"EACH_SLOT {call}")(slots_of_range)
    place = "first + wp.tid() // wp.block_dim()"
    source = f"def {name}({', '.join(types)}):\n    native({place}, {', '.join([*types][1:])})"
    whole = wp.Kernel(kernel, module=module, source=source)
    RANGED.add(whole)
    return whole


@cache
def _with_includes(header: str) -> tuple[str, ...]:
    """Name a header after those that it includes."""
    includes = INCLUDE.findall((FOLDER / header).read_text(encoding="utf-8"))
    return (*(name for include in includes for name in _with_includes(include)), header)


@cache
def _text(header: str) -> str:
    """Read a header without the lines that are for editors, and compilers of single files."""
    text = (FOLDER / header).read_text(encoding="utf-8")
    return INCLUDE.sub("", text).replace("#pragma once\n", "")


@wp.func_native("return lane_of_slot();")
def lane() -> wp.int32:
    """Return the number of a thread in its slot."""


@wp.func_native("return width_of_slot();")
def width() -> wp.int32:
    """Tell how many threads a slot has."""


@wp.func_native("return reduce_slot(value, adds);")
def reduce_slot(value: wp.float64, adds: wp.bool) -> wp.float64:
    """Bring what the threads of a slot have to one number."""


@wp.func_native("return sum_of_line(table, line, 0, table.shape[1]);")
def sum_of(table: wp.array2d(dtype=wp.float64), line: wp.int32) -> wp.float64:
    """Add up a line of a table, by all threads of a deciding slot."""


@wp.func_native("return most_of_line(table, line, 0, table.shape[1]);")
def most_of(table: wp.array2d(dtype=wp.float64), line: wp.int32) -> wp.float64:
    """Find the largest of a line of a table, by all threads of a deciding slot."""


@wp.func_native("total_lines(table, adds * table.shape[0], &wp::index(history, row, column));")
def total_of(
    table: wp.array2d(dtype=wp.float64),
    adds: wp.int32,
    history: wp.array2d(dtype=wp.float64),
    row: wp.int32,
    column: wp.int32,
) -> None:
    """Reduce each line of a table to a number, in a row from a column on. All threads of a slot call it."""


#: Numbers of the lines of a table.
Lines = wp.types.vector(length=14, dtype=wp.float64)


@wp.func_native("return lines_of_table<14>(table, columns, sums, lines);")
def lines_of_table(
    table: wp.array2d(dtype=wp.float64), columns: wp.int32, sums: wp.int32, lines: wp.int32
) -> Lines:
    """Bring the first lines of a table to a number each, over some columns: so many sums, then maxima."""
