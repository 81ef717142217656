"""The page of all keys is what the declarations of the keys say."""

import subprocess
import sys
from pathlib import Path

from warpwear import Study
from warpwear.study.keys import declarations, key_of

ROOT = Path(__file__).parent.parent.parent


def test_the_page_of_keys_is_up_to_date() -> None:
    code = "import make_keys; print(make_keys.page(), end='')"
    made = subprocess.run(
        [sys.executable, "-c", code],
        env={"PYTHONPATH": f"{ROOT}:{ROOT / 'docs'}", "PYTHONIOENCODING": "utf-8"},
        cwd=ROOT,
        capture_output=True,
        check=True,
    )
    page = (ROOT / "docs" / "reference" / "keys.md").read_text(encoding="utf-8")
    assert made.stdout.decode("utf-8") == page, "run: python docs/make_keys.py"


def test_every_key_has_a_meaning() -> None:
    for name in declarations(Study):
        info = key_of(Study, name)
        assert info is not None
        assert info.description or "." not in name, name
