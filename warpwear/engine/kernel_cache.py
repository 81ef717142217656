"""Warp keeps compiled kernels from one process to the next, by what they are compiled from."""

import shutil
from collections.abc import Callable
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from threading import RLock
from typing import Any

import warp as wp

from warpwear.clock import phase
from warpwear.errors import explained

#: Held while the kernels of a module are looked for and loaded: two threads may want the same ones.
_LOADING: dict[Any, RLock] = {}


def begin_to_load(module: Any, device: Any, pool: Executor | None = None) -> Callable[[], None]:
    """Look for the kernels of Warp's module; return what loads or compiles them.

    pool: does so from now on, and what is returned waits. That raises InputError where they cannot be kept.
    """
    # Compiled in advance, as Warp would, its headers take longer than twice with the kernels of two files.
    wp.config.use_precompiled_headers = device.is_cuda
    with _LOADING.setdefault(module, RLock()):
        is_compiled = _folder(module, device).is_dir()
    load = pool.submit(_load, module, device).result if pool else partial(_load, module, device)

    def finish() -> None:
        with phase("kernels" if is_compiled else "compile"):
            load()

    return finish


def _load(module: Any, device: Any) -> None:
    """Load a module; compile it where Warp cannot load it. Raises InputError where it cannot be kept."""
    with _LOADING[module]:
        try:
            wp.load_module(module, device=device)
        except Exception as error:  # Warp raises whatever a damaged file makes of it
            if isinstance(error, MemoryError):
                raise
            shutil.rmtree(_folder(module, device), ignore_errors=True)
            cache = f"{wp.config.kernel_cache_dir} (WARP_CACHE_PATH names another folder)"
            with explained(f"Warp cannot keep compiled kernels in {cache}"):
                wp.load_module(module, device=device)


def _folder(module: Any, device: Any) -> Path:
    """Return where the kernels of a module are kept compiled for a kind of device."""
    name = module.get_module_identifier(1 if device.is_cpu else None)
    return Path(wp.config.kernel_cache_dir or ".") / name
