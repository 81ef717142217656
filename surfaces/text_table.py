"""Tables of numbers in text: header, separators and decimal sign told apart without guessing."""

import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpwear.surfaces.base import FloatArray

COMMENTS = ("#", "%", "//", "*", "!")
MISSING = re.compile(rb"(?i)\b(?:bad|null|nil|none|na|n/a)\b|\*{2,}|-{2,}")
SAMPLE_LINES = 400
#: Bytes that no text has, and the share of them, zeros aside, in one that is only damaged.
BINARY = bytes([*range(1, 9), *range(14, 32)])
LARGEST_BINARY = 0.05
NUMBER = re.compile(
    r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eEdD][+-]?\d+)?|[+-]?(?:nan|inf|bad|null)|-{2,}|\*{2,}", re.I
)


@dataclass(frozen=True, eq=False)
class Table:
    """Values as they stand, shape (lines, columns), NaN where missing; header: the lines before them."""

    values: FloatArray
    header: tuple[str, ...]
    ended: bool = True  # whether the last line is: of a file cut short it is not


def read_table(path: Path) -> Table:
    """The table of numbers in a text file.

    Separators: tab, spaces, semicolon or comma, the same on every line; decimal point or comma. Empty fields
    and words such as ``NaN``, ``BAD`` or ``***`` are missing values. ValueError, with a sentence's end, for
    rows of unequal length, and where a comma could be either a separator or a decimal sign.
    """
    raw = path.read_bytes()
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raw = raw.decode("utf-16").encode()
    raw = raw.removeprefix(b"\xef\xbb\xbf")
    if b"\x00" in raw:
        _refuse_zeros(raw)
    raw = raw.replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\xc2\xa0", b" ")
    header, body, first = _split(raw)
    if not body.strip():
        raise ValueError("no table of numbers")
    values = _numbers(_unified(body), first=first)
    if values.shape[0] > 1 and header == () and values.shape[1] == 1:
        raise ValueError("a single column of numbers")
    _refuse_lost_rows(header, body, first=first, width=values.shape[1])
    return Table(values=values, header=header, ended=raw.endswith(b"\n"))


def _refuse_zeros(raw: bytes) -> None:
    """ValueError: "no text" for an instrument's own format, the line of the damage for a text with a few."""
    rest = raw[:100000].translate(None, b"\x00")
    if len(rest.translate(None, BINARY)) <= (1.0 - LARGEST_BINARY) * len(rest):
        raise ValueError("no text")
    line = raw.count(b"\n", 0, raw.index(b"\x00")) + 1
    raise ValueError(f"line {line} holds a byte of value 0, which no text has")


def _refuse_lost_rows(header: tuple[str, ...], body: bytes, *, first: int, width: int) -> None:
    """ValueError for a broken row that passed for the header, and for one behind a comment's sign.

    Of two or three columns a header may well be made of a word and numbers.
    """
    if width > 3 and header and not header[-1].startswith(COMMENTS[:3]):
        for separators in (r"[\s;]+", r"[\s;,]+"):
            fields = re.split(separators, header[-1].strip(" \t;,"))
            words = [field for field in fields if not NUMBER.fullmatch(field)]
            if abs(len(fields) - width) <= width // 8 and 0 < len(words) < 0.5 * width:
                raise ValueError(f"line {first - 1} holds {words[0][:20]!r}, which is no number")
    if not any(sign.encode() in body for sign in COMMENTS[:3]):
        return
    for number, line in enumerate(body.decode("utf-8", errors="replace").split("\n"), start=first):
        sign = next((sign for sign in COMMENTS[:3] if line.strip().startswith(sign)), None)
        if sign is not None:
            fields = re.split(r"[\s;]+", line.strip()[len(sign) :].strip(" \t;,"))
            if len(fields) == width > 2 and all(NUMBER.fullmatch(field) for field in fields):
                raise ValueError(f"line {number} is a row of numbers behind a {sign!r}")


def _split(raw: bytes) -> tuple[tuple[str, ...], bytes, int]:
    """Header lines, the rest, and the number of its first line: from there on lines hold numbers alone."""
    header, start, count = [], 0, 0
    while start < len(raw):
        end = raw.find(b"\n", start)
        end = len(raw) if end < 0 else end
        line = raw[start:end].decode("utf-8", errors="replace").strip()
        if _is_data(line):
            following = raw[end + 1 : raw.find(b"\n", end + 1)].decode("utf-8", errors="replace").strip()
            # one or two bare integers over wider rows: a count of points or of the grid, part of the header
            counts = re.fullmatch(r"\d+(?:[\s;,]+\d+)?", line) and _is_data(following)
            if not (counts and len(NUMBER.findall(following)) > len(line.split())):
                break
        if line:
            header.append(line)
        start, count = end + 1, count + 1
        if count > 2000:
            raise ValueError("no table of numbers")
    return tuple(header), raw[start:], count + 1


def _is_data(line: str) -> bool:
    if not line or line.startswith(COMMENTS[:3]):
        return False
    fields = [field for field in re.split(r"[\s;,]+", line) if field]
    return (
        bool(fields) and all(NUMBER.fullmatch(field) for field in fields) and any(c.isdigit() for c in line)
    )


def _unified(body: bytes) -> bytes:
    """The same numbers with points for decimals and one space between fields."""
    sample = [line for line in body[:200000].split(b"\n")[:SAMPLE_LINES] if line.strip()]
    if len(body) > 400000:  # the end may differ from the beginning
        sample += [line for line in body[-200000:].split(b"\n")[1:][-SAMPLE_LINES:] if line.strip()]
    semicolons, tabs, commas = (body.count(c) > 0 for c in (b";", b"\t", b","))
    if MISSING.search(b"\n".join(sample)) or re.search(rb"(?i)bad|null|\*\*|--", body):
        body = MISSING.sub(b"nan", body)
    if commas:
        if semicolons or tabs:
            joined = b"\n".join(sample)
            if re.search(rb"\d\.\d*,\d|,\d*\.\d", joined) or re.search(rb",[;\t\n]|[;\t],", joined + b"\n"):
                raise ValueError("mixed separators: commas beside semicolons or tabs, and decimal points")
            body = body.replace(b",", b".")
        elif _comma_is_decimal(sample):
            body = body.replace(b",", b".")
        else:
            body = _explicit(body, b",", sample)
    if semicolons and tabs:
        if re.search(rb";[ \t]*;|\t\t", body):
            raise ValueError("mixed separators: semicolons and tabs, with empty fields")
        body = body.translate(bytes.maketrans(b";", b" "))
    elif semicolons:
        body = _explicit(body, b";", sample)
    elif tabs:
        body = _explicit(body, b"\t", sample)
    return body


def _comma_is_decimal(sample: list[bytes]) -> bool:
    """Of a table whose only other separator is blank. ValueError where both readings make sense."""
    points = any(b"." in line for line in sample)
    spaced = any(re.search(rb"\d +[-+\d]", line.strip()) for line in sample)
    if points:
        if spaced and any(re.search(rb"\d\.\d+,\d|\d,\d+\.\d", line) for line in sample):
            raise ValueError("mixed separators: blanks and commas, and decimal points")
        return False
    if any(re.search(rb", |,,|,\s*$", line) for line in sample):
        if spaced:
            raise ValueError("mixed separators: blanks and commas")
        return False
    if spaced:
        return True
    fields = [line.strip().split(b",") for line in sample]
    odd = any(len(line) % 2 for line in fields)
    signed = any(f.strip()[:1] in (b"-", b"+") for line in fields for f in line[1::2])
    if not (odd or signed):
        raise ValueError("a comma between all digits, which may be a separator or a decimal sign")
    return False


def _explicit(body: bytes, separator: bytes, sample: list[bytes]) -> bytes:
    """Blanks for a separator, ``nan`` for the empty fields between two of them."""
    if all(line.rstrip(b" ").endswith(separator) for line in sample):  # each line ends in one
        body = re.sub(separator + rb"[ ]*(?=\n|$)", b"", body)
    filler = b"[ ]*"
    if re.search(separator + filler + rb"(?:" + separator + rb"|\n|$)", body) or re.search(
        rb"(?:^|\n)" + filler + separator, body
    ):
        body = re.sub(rb"(?m)(?<=" + separator + rb")" + filler + rb"(?=" + separator + rb"|$)", b"nan", body)
        body = re.sub(rb"(?m)^" + filler + rb"(?=" + separator + rb")", b"nan", body)
    return body.replace(separator, b" ")


def _numbers(body: bytes, *, first: int) -> FloatArray:
    try:
        return np.loadtxt(io.BytesIO(body), comments=list(COMMENTS[:3]), ndmin=2, dtype=np.float64)
    except ValueError as error:
        raise ValueError(_fault(body, first=first) or str(error).splitlines()[0]) from error


def _fault(body: bytes, *, first: int) -> str:
    """What is wrong with the first bad line, in words."""
    wanted = None
    for number, line in enumerate(body.split(b"\n"), start=first):
        if not line.strip() or line.strip().startswith(tuple(c.encode() for c in COMMENTS[:3])):
            continue
        fields = line.split()
        for field in fields:
            try:
                float(field)
            except ValueError:
                shown = field.decode(errors="replace")[:20]
                return f"line {number} holds {shown!r}, which is no number"
        wanted = len(fields) if wanted is None else wanted
        if len(fields) != wanted:
            return (
                f"line {number} has {len(fields)} values where the others have {wanted}: ragged rows or "
                "mixed separators"
            )
    return ""
