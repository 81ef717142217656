"""What tests of comparisons share: the call, the command, and the sentence that it refuses with."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from click.testing import CliRunner, Result

import warpwear
from warpwear import ComparedRuns
from warpwear.cli.compare import compare
from warpwear.errors import InputError


def warpwear_compare(*arguments: str | Path) -> Result:
    return CliRunner().invoke(compare, [*map(str, arguments)])


def refusal(*arguments: str | Path) -> str:
    done = warpwear_compare(*arguments)
    assert isinstance(done.exception, InputError), done.output
    return done.exception.sentence


def gather(folders: Sequence[Path], experiments: Sequence[Path] = (), **options: Any) -> ComparedRuns:
    """Compare folders and records."""
    return warpwear.compare(*folders, experiments=experiments, **options)
