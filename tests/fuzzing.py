"""What the tests with broken input share: mutations of text, of nested keys and of bytes, and watches."""

import json
import os
import random
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

import pytest

from warpwear.errors import InputError

#: Nothing that is only read may take longer, of the processor's time [s].
LONGEST = 5.0

#: Longest that a file of 5 MB may take of the processor's time [s].
LARGE, LONGEST_LARGE = 5_000_000, 10.0
#: Bytes at either end of a file in which most of what it says of itself stands.
ENDS = 2048
#: More memory than once everything is loaded [bytes].
MOST_MEMORY = 2**30
#: "k/n" in this variable leaves of every fuzz the k-th of n shares, k from 0, so that n processes make all.
SHARE = "FUZZ_SHARE"


def numbers(count: int) -> range:
    """Numbers of the cases that are this process's of so many."""
    first, shares = map(int, os.environ.get(SHARE, "0/1").split("/"))
    return range(first, count, shares)


@contextmanager
def little_memory() -> Iterator[None]:
    """Fails where what is done takes more memory than is allowed, at its peak."""
    resource = pytest.importorskip("resource")
    unit = 1 if sys.platform == "darwin" else 1024

    def peak() -> int:
        return unit * max(
            resource.getrusage(w).ru_maxrss for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        )

    before = peak()
    yield
    taken = peak() - before
    print(f"{taken / 2**20:.0f} MiB more at the peak")
    assert taken < MOST_MEMORY, f"takes {taken / 2**30:.2f} GiB"


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


def located(error: Exception) -> str:
    """An error and the place in the code that raised it."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    return f"{error!r} in {last.filename}:{last.lineno}"


def check_sentence(error: Exception) -> None:
    """For a terminal: one line that ends as a sentence does, of a length that is read."""
    message = str(error)
    assert message.isprintable(), repr(message)
    assert message.endswith((".", "?")), message
    assert 10 < len(message) < 1200, message
    assert "typing." not in message, message
    assert "NoneType" not in message, message


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


def mutated_file(content: bytes, dice: random.Random) -> bytes:
    """Content of some MB, mostly at its ends: broken as above, cut, with garbage in it or a huge count."""
    place = dice.randrange(3)
    at = dice.randrange(len(content)) if place == 0 else dice.randrange(ENDS) - ENDS * (place == 2)
    at %= len(content)
    how = dice.randrange(5)
    if how == 0:
        return content[: dice.randrange(len(content))]
    if how == 1:
        return content[:at] + dice.randbytes(dice.choice((1, 100, 100_000))) + content[at:]
    if how == 2:
        count = dice.choice((b"\xff\xff\xff\x7f", b"\x7f\xff\xff\xff", b"99999999", b"\0" * 8, b"-1e999"))
        return content[:at] + count + content[at + len(count) :]
    start = max(at - ENDS // 2, 0) if how == 3 else 0
    stop = start + ENDS if how == 3 else len(content)
    return content[:start] + mutated_bytes(content[start:stop], dice) + content[stop:]


def in_a_child(work: Callable[[], object]) -> tuple[str, float, int]:
    """Do work on a file of some MB in a process of its own, within what it may cost.

    Return the sentence by which it was refused, or nothing, its processor's time [s] and most memory [bytes].
    """
    resource = pytest.importorskip("resource")
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        told = ["defect", "ended without a word"]
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (int(2 * LONGEST_LARGE), int(3 * LONGEST_LARGE)))
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            work()
            told = ["read", ""]
        except InputError as error:
            check_sentence(error)
            told = ["refused", str(error)]
        except BaseException as error:
            told = ["defect", repr(error) if isinstance(error, AssertionError) else located(error)]
        finally:
            os.write(writing, json.dumps(told).encode()[:4000])
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as answer:
        how, said = json.loads(answer.read() or b'["defect", "was killed"]')
    used = os.wait4(child, 0)[2]
    seconds = used.ru_utime + used.ru_stime
    memory = used.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    assert how != "defect", said
    assert seconds < LONGEST_LARGE, f"takes {seconds:.1f} s: {said}"
    assert memory < MOST_MEMORY, f"takes {memory / 2**30:.2f} GiB: {said}"
    return said, seconds, memory
