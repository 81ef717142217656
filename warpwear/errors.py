"""How a run can end badly, and what misleads of one that ends well: each is one sentence for the user."""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

#: What the command line and Python call by different names, for the sentences of both.
OVERWRITE_IT = "overwrite it (--overwrite, overwrite=True)"
OTHER_FOLDER = f"give another folder (out), or {OVERWRITE_IT}"
RESUME_IT = "resume it (--resume, resume=True)"


#: An option of the command line in a sentence, with what Python calls it where both stand there.
_OPTION = re.compile(r"(?<![\w-])--([a-z][a-z-]*)(, (?=\1s?=))?")


def in_python(text: str) -> str:
    """Name options in a text as Python does: height_unit for --height-unit."""
    return _OPTION.sub(lambda match: "" if match[2] else match[1].replace("-", "_"), text)


def prose(name: str) -> dict[str, Any]:
    """Read the sentences of a file of `templates/sentences/`."""
    return tomllib.loads((Path(__file__).parent / "templates/sentences" / f"{name}.toml").read_text("utf-8"))


def sentences(name: str) -> Callable[..., str]:
    """Return what fills in a sentence of such a file, by its name, with values by its fields."""
    texts = prose(name)

    def say(sentence: str, /, **values: Any) -> str:
        return str(texts[sentence].format(**values))

    return say


def printable(text: str) -> str:
    """Put a text on one line: a file or a user may give line ends, or signs that do things to a terminal."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def escaped(text: str) -> str:
    """Write signs of a name that no text can have, as those of an old archive are, as \\udcfc."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


#: Such a sign as `escaped` writes it, and TOML.
_ESCAPED = re.compile(r"\\{1,2}u(dc[89a-f][0-9a-f])")


def unescaped(text: str) -> str:
    """Return a text, or one of TOML, with the signs back that `escaped` wrote."""
    return _ESCAPED.sub(lambda sign: chr(int(sign[1], 16)), text)


class InputError(ValueError):
    """Bad input: one sentence that names the field, the value and what is allowed. Exit status 2."""

    def __init__(self, sentence: str) -> None:
        line = printable(sentence)
        #: The sentence with options as the command line has them, where a public function names its own.
        self.sentence = line if line.endswith((".", "?")) else f"{line}."
        super().__init__(self.sentence)


@contextmanager
def explained(what: str) -> Iterator[None]:
    """Turn an error of the system into an InputError. what: the sentence up to the reason."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{what}: {error.strerror or error}") from error


@contextmanager
def named_in_python() -> Iterator[None]:
    """Name options in the sentence of an InputError as Python does; `sentence` keeps the command line's."""
    try:
        yield
    except InputError as error:
        error.args = (in_python(str(error)),)
        raise


@contextmanager
def reworded(words: Callable[[str], str] | Mapping[str, str]) -> Iterator[None]:
    """Say the sentence of an InputError in other words: by a function, or old ones -> new ones."""
    try:
        yield
    except InputError as error:
        text = error.sentence if isinstance(words, Mapping) else words(error.sentence)
        for old, new in words.items() if isinstance(words, Mapping) else ():
            text = text.replace(old, new)
        raise InputError(text) from error.__cause__


class InvariantError(InputError):
    """A step that breaks what must hold of every step. The run stops, and keeps what came before."""


class ConvergenceError(RuntimeError):
    """A solve that did not meet its tolerance: the message names the residual. Never reported as success."""


class StudyWarning(UserWarning):
    """What misleads in a run that can be computed: a key that is not used, say, or a contact of few cells."""
