"""Compiled kernels are kept by Warp; damaged ones are compiled anew."""

import errno
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import warp as wp
from fuzzing import check_sentence

from warpwear import InputError
from warpwear.engine import kernel_cache
from warpwear.engine.device import find_device
from warpwear.engine.executor import Executor
from warpwear.grid import Grid
from warpwear.kernels import balance, contact


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
