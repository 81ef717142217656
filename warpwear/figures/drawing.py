"""The process that only draws: orders on its standard input, pictures on its standard output.

It imports neither a result nor a study, which would take it longer than most figures.
"""

import pickle
import sys
from contextlib import suppress
from types import SimpleNamespace

from warpwear import lazy
from warpwear.figures import fields, history, patches, shape, snapshots, track
from warpwear.figures import style as fs

#: The files that places of figures name.
FILES = (fields, history, patches, shape, snapshots, track)
BY_NAME = {file.__name__.rpartition(".")[2]: file for file in FILES}


def main() -> None:
    """Draw what is ordered until there are no more orders; then hand over the pictures."""
    orders = sys.stdin.buffer
    pictures: dict[str, bytes] = {}
    fs.bytes_of(fs.new_figure(lambda axes: axes.semilogx([1.0, 10.0], [0.0, 1.0])))  # loads fonts meanwhile
    with suppress(EOFError):
        while True:
            needed, places = pickle.load(orders)
            data = SimpleNamespace(**needed)
            for name, place in places.items():
                file, _, function = place.partition(":")
                with suppress(Exception):  # who ordered it draws it then, and says what is wrong
                    if file not in BY_NAME:  # a page, which shows pictures
                        pictures[name] = lazy.resolve(place)(needed, pictures)
                        continue
                    pictures[name] = fs.bytes_of(getattr(BY_NAME[file], function)(data))
    pickle.dump(pictures, sys.stdout.buffer)
    sys.stdout.flush()
