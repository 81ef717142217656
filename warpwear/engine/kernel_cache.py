"""Compiled kernels, which Warp keeps from one process to the next: are they still what was compiled?

A damaged one may crash, or compute something else. Beside each lie the digests of its files.
"""

import atexit
import hashlib
import json
import os
import re
import shutil
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import warp as wp

from warpwear.clock import phase
from warpwear.errors import InputError

DIGESTS = "digests.json"
#: What Warp is still compiling: names that end in numbers of a process and a thread.
UNFINISHED = re.compile(r"_p\d+_t\d+$")
#: Names of the modules that this process has loaded, and the devices: what is in memory no file can damage.
_LOADED: set[tuple[str, str]] = set()


def begin_to_load(module: Any, device: Any, pool: Executor | None = None) -> Callable[[], None]:
    """Look for the kernels of Warp's module, whose damaged files go; return what loads or compiles them.

    pool: does so from now on, and what is returned waits. That raises InputError where they cannot be kept.
    """
    # Compiled in advance, as Warp would, its headers take longer than twice with the kernels of two files.
    wp.config.use_precompiled_headers = device.is_cuda
    if not _LOADED:
        atexit.unregister(_seal)
        atexit.register(_seal)
    kept = (module.name, str(device)) in _LOADED
    for folder in () if kept else _folders(module.name):
        if (folder / DIGESTS).exists() and not _is_whole(folder):
            shutil.rmtree(folder, ignore_errors=True)
        kept = kept or folder.name == module.get_module_identifier(1 if device.is_cpu else None)
    load = pool.submit(_load, module, device).result if pool else partial(_load, module, device)

    def finish() -> None:
        with phase("kernels" if kept else "compile"):
            load()
        _LOADED.add((module.name, str(device)))

    return finish


def _load(module: Any, device: Any) -> None:
    try:
        wp.load_module(module, device=device)
    except Exception as error:  # Warp raises whatever a damaged file makes of it
        if isinstance(error, MemoryError):
            raise
        for folder in _folders(module.name):
            shutil.rmtree(folder, ignore_errors=True)
        try:
            wp.load_module(module, device=device)
        except OSError as fault:
            raise InputError(
                f"Warp cannot keep compiled kernels in {wp.config.kernel_cache_dir}: {fault.strerror}; "
                "WARP_CACHE_PATH names another folder."
            ) from fault


def _seal() -> None:
    """Note the digests of files that have none yet, of the modules that were loaded."""
    for folder in (folder for name in {name for name, _ in _LOADED} for folder in _folders(name)):
        with suppress(OSError, ValueError):  # a cache that cannot be written is used as it is
            path = folder / DIGESTS
            kept = json.loads(path.read_text()) if path.exists() else {}
            files = {p.name for p in folder.iterdir() if p.suffix not in (".cpp", ".cu", ".json", ".new")}
            if files <= kept.keys():
                continue
            kept |= {name: _digest(folder / name) for name in files - kept.keys()}
            new = path.with_suffix(f".{os.getpid()}.new")
            new.write_text(json.dumps(kept))
            new.replace(path)


def _is_whole(folder: Path) -> bool:
    try:
        kept = json.loads((folder / DIGESTS).read_text())
        return all(_digest(folder / name) == digest for name, digest in kept.items())
    except (OSError, ValueError, AttributeError, RecursionError):
        return False


def _digest(path: Path) -> str:
    return hashlib.blake2b(path.read_bytes(), digest_size=16).hexdigest()


def _folders(module: str) -> Iterator[Path]:
    """Where the kernels of a module are kept compiled."""
    for folder in Path(wp.config.kernel_cache_dir or ".").glob(f"wp_{module}_*"):
        if folder.is_dir() and not UNFINISHED.search(folder.name):
            yield folder
