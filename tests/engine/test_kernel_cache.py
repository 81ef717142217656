"""Compiled kernels are kept by Warp; damaged ones are compiled anew."""

import errno
import time
from collections.abc import Callable
from pathlib import Path
from threading import Barrier, Thread
from typing import Any

import pytest
import warp as wp
from fuzzing import check_sentence

from warpwear import InputError
from warpwear.engine import kernel_cache
from warpwear.engine.device import find_device
from warpwear.engine.executor import Executor
from warpwear.grid import Grid
from warpwear.kernels import balance, contact, native_code


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    find_device("cpu")
    monkeypatch.setattr(wp.config, "kernel_cache_dir", str(tmp_path))
    return wp.get_module(contact.__name__)


def test_a_cache_that_cannot_be_written_is_a_sentence(
    module: Any, failing: Callable[[str, Exception], None]
) -> None:
    failing("warp.load_module", OSError(errno.ENOSPC, "No space left on device"))
    load = kernel_cache.begin_to_load(module, wp.get_device("cpu"))
    with pytest.raises(InputError, match=r"Warp cannot keep compiled kernels in .*: No space left") as error:
        load()
    check_sentence(error.value)


def test_files_that_warp_cannot_load_are_compiled_anew(
    module: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    device = wp.get_device("cpu")
    folder = tmp_path / module.get_module_identifier(1)
    folder.mkdir()
    (folder / "damaged.o").write_bytes(b"")
    there: list[bool] = []

    def load(*_: Any, **__: Any) -> None:
        there.append(folder.exists())
        if folder.exists():
            raise RuntimeError("no object file")

    monkeypatch.setattr(wp, "load_module", load)
    kernel_cache.begin_to_load(module, device)()
    assert there == [True, False]


def test_kernels_of_a_run_are_compiled_as_one_file(module: Any) -> None:
    with Executor(Grid(8, 8, 0.01)) as executor:
        assert executor.load(contact.gap) is contact.gap
        executor.foresee([contact.gap, balance.check_list], together=True)
        gap, listed = (executor.load(kernel) for kernel in (contact.gap, balance.check_list))
        assert gap.module is listed.module
        assert gap.module not in (contact.gap.module, balance.check_list.module)
        executor.foresee([contact.gap, balance.check_list], together=True)  # by a model that is made later
        assert executor.load(contact.gap) is gap


def test_threads_share_the_copies_of_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Copies made twice would change a module below the launches of another thread."""
    made = native_code.options
    monkeypatch.setattr(native_code, "options", lambda *headers: (time.sleep(0.05), made(*headers))[1])
    kernels, barrier, copies = (contact.gap, balance.check_list), Barrier(4), list[list[Any]]()

    def foresee() -> None:
        with Executor(Grid(8, 8, 1.0), threads=1) as executor:
            barrier.wait()
            executor.foresee(kernels, together=True)
            copies.append([executor.load(kernel) for kernel in kernels])

    native_code.together.cache_clear()
    threads = [Thread(target=foresee) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(copies) == 4
    assert all(one is other for each in copies[1:] for one, other in zip(copies[0], each, strict=True))
