"""Kernels and the C++ behind them compile for every device, also for those that are not here."""

import importlib
from pathlib import Path

import pytest
import warp as wp

from warpwear.engine.kernel_cache import begin_to_load
from warpwear.kernels import native_code


def named(path: Path) -> str:
    """Name a file of kernels as a module."""
    return "warpwear.kernels." + ".".join(path.relative_to(FOLDER).with_suffix("").parts)


FOLDER = Path(native_code.__file__).parent
HEADERS = sorted(path.relative_to(native_code.FOLDER).as_posix() for path in native_code.FOLDER.rglob("*.h"))
TEXTS = {path: path.read_text(encoding="utf-8") for path in sorted(FOLDER.rglob("*.py"))}
KERNELS = [
    kernel
    for path, text in TEXTS.items()
    if "@wp.kernel" in text or "_pass(" in text or "of_both(" in text
    for value in vars(importlib.import_module(named(path))).values()
    for kernel in (value.values() if isinstance(value, dict) else (value,))  # one a kind of number
    if isinstance(kernel, wp.Kernel)
]
#: What Warp compiles at once: the kernels of a file or of some.
MODULES = {kernel.module.name: kernel.module for kernel in KERNELS}
#: Compute capability of a GPU for which kernels are compiled without one.
ARCHITECTURE = 90


def nothing(number: wp.int32):
    """Be a kernel, which Warp asks of a module."""


@pytest.mark.parametrize("name", MODULES)
def test_kernels_compile_for_a_cpu(name: str) -> None:
    begin_to_load(MODULES[name], wp.get_device("cpu"))()


def test_no_two_kernels_of_a_module_have_one_name() -> None:
    """A recording knows them by it, and would launch one with the arguments of the other."""
    different = {(kernel.module.name, kernel.key): kernel for kernel in KERNELS}
    assert len(different) == len({id(kernel) for kernel in KERNELS})


def test_every_header_belongs_to_kernels() -> None:
    """Some module's own, or included by one."""
    own = {header for header in HEADERS if any(f'"{header}"' in text for text in TEXTS.values())}
    assert {name for header in own for name in native_code._with_includes(header)} == set(HEADERS)


@pytest.mark.slow
@pytest.mark.parametrize("header", HEADERS)
def test_a_header_includes_what_it_needs(header: str, tmp_path: Path) -> None:
    """So that no module of kernels has to know in which order headers come."""
    module = wp.get_module(f"header.{Path(header).stem}")
    wp.set_module_options(native_code.options(header), module=module)
    wp.Kernel(nothing, module=module)
    assert wp.compile_aot_module(module, device="cpu", module_dir=tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", MODULES)
def test_kernels_compile_for_a_gpu(name: str, tmp_path: Path) -> None:
    """By NVIDIA's compiler, which comes with Warp; no GPU is needed."""
    if ARCHITECTURE not in wp.get_cuda_supported_archs():
        pytest.skip("Warp without NVIDIA's compiler")
    wp.compile_aot_module(MODULES[name], device=None, arch=ARCHITECTURE, module_dir=tmp_path, use_ptx=True)
    (compiled,) = tmp_path.glob("*.ptx")
    assert ".entry" in compiled.read_text(encoding="utf-8")
