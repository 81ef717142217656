"""What tests of `warpwear compare` share: the command, and the sentence that it refuses with."""

from pathlib import Path

from click.testing import CliRunner, Result

from warpwear.cli.compare import compare
from warpwear.errors import InputError


def warpwear_compare(*arguments: str | Path) -> Result:
    return CliRunner().invoke(compare, [*map(str, arguments)])


def refusal(*arguments: str | Path) -> str:
    done = warpwear_compare(*arguments)
    assert isinstance(done.exception, InputError), done.output
    return done.exception.sentence
