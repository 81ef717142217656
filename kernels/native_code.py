"""C++ of kernels: headers in `native/`, which stand before the code that Warp makes of a module.

A native function of a module is a line that calls what a header defines. Headers are templates, as the
structs of a module come after them, and text of the module: a header that changes is compiled anew.
"""

from functools import cache
from pathlib import Path
from typing import Any

import warp as wp

FOLDER = Path(__file__).with_name("native")
#: Lines of a header that tell an editor and a compiler of single files where the others are.
FOR_EDITORS = ("#pragma once", '#include "')


def options(*headers: str) -> dict[str, Any]:
    """Return the options of a module whose native functions call these headers; `lanes.h` comes first."""
    text = "".join(map(_text, dict.fromkeys(("lanes.h", *headers))))
    build = wp.ModuleBuildOptions(extra_cpu_preamble=text, extra_cuda_preamble=text)
    return {"enable_backward": False, "extra_build_options": build}


@cache
def _text(header: str) -> str:
    lines = (FOLDER / header).read_text(encoding="utf-8").splitlines()
    return "\n".join(line for line in lines if not line.startswith(FOR_EDITORS)) + "\n"
