"""How a run can end badly, and what misleads of one that ends well: each is one sentence for the user."""

from collections.abc import Iterator
from contextlib import contextmanager

#: What the command line and Python call by different names, for the sentences of both.
OVERWRITE_IT = "overwrite it (--overwrite, overwrite=True)"
OTHER_FOLDER = f"give another folder (out), or {OVERWRITE_IT}"
RESUME_IT = "resume it (--resume, resume=True)"


def printable(text: str) -> str:
    """Put a text on one line: a file or a user may give line ends, or signs that do things to a terminal."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


class InputError(ValueError):
    """Bad input: one sentence that names the field, the value and what is allowed. Exit status 2."""

    def __init__(self, sentence: str) -> None:
        line = printable(sentence)
        super().__init__(line if line.endswith((".", "?")) else f"{line}.")


@contextmanager
def explained(what: str) -> Iterator[None]:
    """Turn an error of the system into an InputError. what: the sentence up to the reason."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{what}: {error.strerror or error}") from error


class InvariantError(InputError):
    """A step that breaks what must hold of every step. The run stops, and keeps what came before."""


class ConvergenceError(RuntimeError):
    """A solve that did not meet its tolerance: the message names the residual. Never reported as success."""


class StudyWarning(UserWarning):
    """What misleads in a run that can be computed: a key that is not used, say, or a contact of few cells."""
