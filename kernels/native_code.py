"""C++ of kernels: headers in `native/`, which stand before the code that Warp makes of a module.

A native function of a module is a line that calls what a header defines. Headers are templates, as the
structs of a module come after them, and text of the module: a header that changes is compiled anew.
"""

import re
from functools import cache
from pathlib import Path
from typing import Any

import warp as wp

FOLDER = Path(__file__).with_name("native")
#: A line of a header that names another one, which comes before it.
INCLUDE = re.compile(r'^#include "(.+)"$', re.MULTILINE)


def options(*headers: str) -> dict[str, Any]:
    """Return the options of a module whose native functions call these headers, or `lanes.h` alone."""
    names = dict.fromkeys(name for header in headers or ("lanes.h",) for name in _with_includes(header))
    text = "".join(_text(name) for name in names)
    build = wp.ModuleBuildOptions(extra_cpu_preamble=text, extra_cuda_preamble=text)
    return {"enable_backward": False, "extra_build_options": build}


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


def a_pass(name: str, call: str, kind: Any, *, module: Any = None) -> Any:
    """Make a kernel of slots and a struct that calls a C++ function once for each slot.

    call: a line of C++ in which these are `slot`, `slots` and `it`. kind: the struct. module: of the kernel;
    None: that of the struct.
    """

    def native(slot: wp.int32, slots: wp.int32, it: kind): ...  # type: ignore[valid-type]

    native.__name__ = native.__qualname__ = f"_{name}"
    native.__module__ = kind.cls.__module__
    of_slot = wp.func_native(call)(native)

    def kernel(first_slot: wp.int32, slots: wp.int32, it: kind):  # type: ignore[valid-type]
        of_slot(first_slot + wp.tid() // wp.block_dim(), slots, it)

    return wp.kernel(kernel, name=name, module=module or wp.get_module(kind.cls.__module__))
