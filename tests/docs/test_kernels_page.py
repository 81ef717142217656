"""The pass that the page on kernels shows does what the page says."""

import importlib.util
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import warp as wp

from warpwear.kernels import native_code

PAGE = Path(__file__).parents[2] / "docs" / "developer" / "kernels.md"
#: What the page names before its example, or has named elsewhere.
IMPORTS = """import warp as wp
from warpwear.kernels import native_code
from warpwear.kernels.cells import FIELD, TABLE, Cells

"""


def test_the_pass_that_is_shown_adds_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, device: str) -> None:
    headers = shutil.copytree(native_code.FOLDER, tmp_path / "native")
    monkeypatch.setattr(native_code, "FOLDER", headers)
    page = PAGE.read_text(encoding="utf-8")
    (header,) = re.findall(r"```cpp\n(.*?)```", page, re.DOTALL)
    (headers / "my_pass.h").write_text(header, encoding="utf-8")
    (source,) = re.findall(r"```python\n(native_pass = .*?)```", page, re.DOTALL)
    (tmp_path / "shown.py").write_text(IMPORTS + source, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("shown", tmp_path / "shown.py")
    assert spec is not None
    assert spec.loader is not None
    shown = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(shown)
    values = np.random.default_rng(1).uniform(size=(5, 3, 8))
    pressure = wp.array(values, dtype=shown.Cells, device=device)
    sums = wp.zeros((1, 5), dtype=wp.float64, device=device)
    width = 256 if wp.get_device(device).is_cuda else 1
    slots = {"dim": 5 * width, "block_dim": width} if width > 1 else {"dim": 1, "block_dim": 1}
    wp.launch(shown.carried, inputs=[0, 5, 5, pressure, sums], device=device, **slots)
    np.testing.assert_allclose(sums.numpy()[0], values.sum(axis=(1, 2)), rtol=1e-14)
