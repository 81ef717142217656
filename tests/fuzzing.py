"""What the tests with broken input share: mutations of text, of nested keys and of bytes, and a watch."""

import random
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from hypothesis import strategies as st

#: Nothing that is only read may take longer, of the processor's time [s].
LONGEST = 5.0

WORDS = """inf mm|-inf N|nan MPa|1e400 mm|0 mm|-1 um|8 N|3 GPa|1 mm^3/N/m|1/m|1e-300 mm|1e300 N|5 µm|10 Å
|2 min|inf s|1 Hz|60 rpm|90 deg|200 HV10|60 HRC|0,55|1e-4 mm3/Nm|auto
|one cell|area|macro|micro|self-affine|milled|flat|explicit|implicit|radial|updated"""
NUMBERS = "1_0|0x10|1e|.5.|½|٣|--1|1e-30|1e30"
UNITS = """mm|um|m|km|N|Nm|mm³/N·m|mm2|turn/s|rad|HV|HB|HRC|/|/N·m
|MPa|Pa^-1|mm^2/N|mm^3/N/m|degC|dB|mol|()|^9|mm/min|J/m^2|deg|parsec|m**9999999|(((m
|__import__('os')|1|%|‰"""
#: What is little once and too much when it is repeated.
LONG = ["a.", "9", " ", "m*", "(", "[", '"', "8 N ", "mm/", "\n", "HV "]


def one_of(words: str) -> st.SearchStrategy[str]:
    """Of words between bars."""
    return st.sampled_from([word.strip("\n") for word in words.split("|")])


#: What numbers with units, and what is none, may look like in a study.
VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=12),
    one_of(WORDS),
    st.builds(
        "{}{}{}".format,
        st.one_of(st.floats(), st.integers(), one_of(NUMBERS)),
        st.sampled_from(["", " ", "  ", "\t", "\n", "*", "/", " 1/"]),
        one_of(UNITS),
    ),
    st.builds(lambda piece, times: piece * times, st.sampled_from(LONG), st.integers(1, 60_000)),
    st.lists(st.one_of(st.integers(), one_of("1 mm|3 N|-2 mm|nan mm")), max_size=4),
    st.dictionaries(one_of("kind|a|load|"), st.sampled_from(["flat", "1 mm", 3]), max_size=2),
)


@contextmanager
def watched(seconds: float = LONGEST) -> Iterator[None]:
    """Fails what uses the processor for longer, an endless loop too, or what swallows every error."""
    started = time.process_time()
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def too_long(number: int, frame: FrameType | None) -> None:
        raise AssertionError(f"takes more than {seconds:g} s")

    before = signal.signal(signal.SIGVTALRM, too_long)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)
    assert time.process_time() - started < seconds + 1.0, f"takes more than {seconds:g} s"


def check_sentence(error: Exception) -> None:
    """For a terminal: one line that ends as a sentence does, of a length that is read."""
    message = str(error)
    assert message.isprintable(), repr(message)
    assert message.endswith((".", "?")), message
    assert 10 < len(message) < 1200, message


def paths_in(nested: dict[str, Any], prefix: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Where there is a key, sections included."""
    found = []
    for name, value in nested.items():
        found.append((*prefix, name))
        if isinstance(value, dict):
            found += paths_in(value, (*prefix, name))
    return found


def mutated_text(text: str, dice: random.Random) -> str:
    """A text with one to four pieces cut, doubled, moved, or replaced by odd signs."""
    signs = [
        "\x00",
        "\ufeff",
        "\r",
        '"',
        "'",
        '"""',
        "[",
        "]",
        "[[",
        "{",
        "=",
        "#",
        "\\",
        "\\u",
        "\n",
        ",",
        ".",
    ]
    signs += [
        "½",
        "٣",
        "é",
        "\U0001f600",
        "\u2028",
        "1e999",
        "-",
        "_",
        "0x",
        "inf",
        "nan",
        "true",
        "2026-01-01",
        "a." * 50_000,
        "9" * 50_000,
    ]
    for _ in range(dice.randint(1, 4)):
        a, b = sorted(dice.randrange(len(text) + 1) for _ in range(2))
        b = min(b, a + dice.choice((1, 5, 40, len(text))))
        piece = text[a:b]
        how = dice.randrange(5)
        if how == 0:
            text = text[:a] + text[b:]
        elif how == 1:
            text = text[:b] + piece + text[b:]
        elif how == 2:
            text = text[:a] + dice.choice(signs) + text[b if dice.random() < 0.3 else a :]
        elif how == 3:
            lines = text.split("\n")
            dice.shuffle(lines) if dice.random() < 0.2 else lines.insert(
                dice.randrange(len(lines)), dice.choice(lines)
            )
            text = "\n".join(lines)
        else:
            text = text[:a]
        text = text or " "
    return text


def mutated_bytes(content: bytes, dice: random.Random) -> bytes:
    """Content with one to eight bytes changed, or cut, doubled or zeroed in places."""
    found = bytearray(content)
    how = dice.randrange(6)
    if how < 3:
        for _ in range(dice.randint(1, 8)):
            found[dice.randrange(len(found))] ^= 1 << dice.randrange(8) if how else dice.randint(1, 255)
        return bytes(found)
    a = dice.randrange(len(found))
    b = min(len(found), a + dice.choice((1, 16, 512, 4096)))
    if how == 3:
        del found[a:b]
    elif how == 4:
        found[b:b] = found[a:b]
    else:
        found[a:b] = bytes(b - a)
    return bytes(found)
