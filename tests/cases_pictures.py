"""Pictures for tests that ask which there are and not how they look."""

import base64
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from matplotlib.figure import Figure

from warpwear.figures import process, style

#: Dots per inch that are soon drawn.
DOTS = 50.0
#: A PNG file of one white dot.
BLANK = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAG7buVgAAAABJRU5ErkJggg=="
)


@contextmanager
def quick_pictures(*, blank: bool = False) -> Iterator[None]:
    """Draw pictures of few dots, and those of a run in its own process: a second one takes long to start.

    blank: figures are made, but not laid out and drawn: each PNG file is a white dot.
    """
    start, write = process.Painter.__init__, style.bytes_of

    def few_dots(figure: Figure, file_format: str = "png", **_: Any) -> bytes:
        return BLANK if blank and file_format == "png" else write(figure, file_format, dpi=DOTS)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "bytes_of", few_dots)
        patch.setattr(process.Painter, "__init__", lambda painter, cores: start(painter, 0))
        yield
