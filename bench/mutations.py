"""Damages inputs at random and looks how commands end: with a sentence and status 2, or as if all were well?

    python bench/mutations.py --kind study --cases 2000
    python bench/mutations.py --kind surface --cases 2000 --seed 7 --shard 3/16 --more FOLDER

A case is one file of a kind, damaged, and one command on it, in a folder with files of a user beside it. It
is wrong if it ends otherwise than with status 0, 1 or 2, with status 2 and more or less than one sentence (a
traceback above all), if it takes longer than `--patience`, or if a file of the user is not as it was.
`--more` takes a folder with files of one's own: those that the kind's suffixes fit are damaged too.
"""

import argparse
import contextlib
import hashlib
import io
import random
import shutil
import signal
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np

import warpwear
from warpwear.cli.main import main as command_line

#: What is written in the place of a value.
NONSENSE = (
    *("", "0", "-1", "1e308", "-1e308", "nan", "inf", "1e-320", "true", '""', '"x"', "[]", "[1]", "{}"),
    *('"1"', '"1 mm"', '"-5 um"', '"5 parsec"', '"nan N"', '"inf mm"', '"1e400 N"', '"0 mm"', '"auto"'),
    *(
        '"flat"',
        '["1 mm", "x"]',
        "[[1], [2]]",
        "1979-05-27",
        '"\\u0000"',
        '"μ"',
        "99999999999999999999",
        '"1 m"',
    ),
)
#: What stands in the place of a number of a table.
CELLS = ("", "nan", "-999", "1e400", "x", "1,5", "1 000", "--", "0", "12:00:00", "∞", "#N/A", '"', "1e-320")
#: Rigs of `warpwear new`.
RIGS = ("reciprocating", "rotating", "fretting", "pin", "block-on-ring")
SUFFIXES = {
    "surface": (".npy", ".sur", ".x3p", ".al3d", ".gwy", ".asc", ".txt", ".xyz", ".csv"),
    "record": (".csv", ".txt"),
}
COMMANDS: dict[str, tuple[tuple[str, ...], ...]] = {
    "study": (("show", "{}"), ("run", "{}", "--dry-run")),
    "surface": (("surface", "{}"), ("surface", "{}", "--pixel", "1 um", "--height-unit", "um")),
    "record": (
        *(("record", "{}", "--speed", "10 mm/s"), ("record", "{}", "--radius", "6 mm", "--load", "5 N")),
        ("repeats", "{}", "mine.csv", "--speed", "10 mm/s"),
    ),
    "result": (
        *(("show", "{}"), ("plot", "{}"), ("export", "{}"), ("compare", "{}", "mine")),
        ("report", "{}"),
    ),
}


def texts_damaged(text: bytes, dice: random.Random) -> bytes:
    """Change bytes or lines of a text: cut, doubled, swapped, dropped, or bytes that are no text."""
    lines = text.splitlines(keepends=True) or [b""]
    at, other = dice.randrange(len(lines)), dice.randrange(len(lines))
    match dice.randrange(7):
        case 0:
            return text[: dice.randrange(len(text) + 1)]
        case 1:
            lines[at] = lines[other] + lines[at]
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case 3:
            del lines[at]
        case 4:
            where = dice.randrange(len(text) + 1)
            return text[:where] + dice.randbytes(dice.randrange(1, 9)) + text[where:]
        case 5:
            lines[at] = lines[at].replace(b",", dice.choice((b";", b"\t", b" ")))
        case _:
            lines[at] = (
                lines[at].rstrip() + dice.choice((b",", b"]", b'"', b"\x00", b"\xff", b" #", b"=")) + b"\n"
            )
    return b"".join(lines)


def study_damaged(text: bytes, dice: random.Random) -> bytes:
    """Change values of a study, mostly; its text sometimes."""
    if dice.random() < 0.25:
        return texts_damaged(text, dice)
    lines = text.decode().splitlines()
    keys = [i for i, line in enumerate(lines) if "=" in line and not line.lstrip().startswith("#")]
    for at in dice.sample(keys, min(len(keys), dice.choice((1, 1, 1, 2, 4)))):
        key, _, value = lines[at].partition("=")
        way = dice.random()
        if way < 0.7:
            lines[at] = f"{key}= {dice.choice(NONSENSE)}"
        elif way < 0.8:
            lines[at] = f"{key.strip()[:-1] or 'x'} ={value}"
        else:
            lines[at] = lines[dice.choice(keys)]
    return "\n".join(lines).encode()


def table_damaged(text: bytes, dice: random.Random) -> bytes:
    """Change numbers of a table, mostly; its text sometimes."""
    if dice.random() < 0.4:
        return texts_damaged(text, dice)
    lines = text.decode("utf-8", "surrogateescape").splitlines()
    apart = ";" if ";" in text.decode("utf-8", "replace") else "," if b"," in text else None
    for _ in range(dice.choice((1, 1, 3, 10))):
        at = dice.randrange(len(lines))
        cells = lines[at].split(apart)
        if cells:
            cells[dice.randrange(len(cells))] = dice.choice(CELLS)
        lines[at] = (apart or " ").join(cells)
    return "\n".join(lines).encode("utf-8", "surrogateescape")


def bytes_damaged(content: bytes, dice: random.Random) -> bytes:
    """Change single bytes, mostly in the head of a file, or cut or stretch it."""
    many = bytearray(content)
    match dice.randrange(5):
        case 0:
            return content[: dice.randrange(len(content) + 1)]
        case 1:
            return content + dice.randbytes(dice.randrange(1, 4096))
        case _:
            for _ in range(dice.choice((1, 1, 4, 16))):
                head = dice.random() < 0.7
                many[dice.randrange(min(len(many), 512) if head else len(many))] = dice.randrange(256)
    return bytes(many)


def result_damaged(path: Path, dice: random.Random) -> None:
    """Change a run folder: a field or an attribute of its result, the result's bytes, or what lies beside."""
    file = path / "result.h5"
    if dice.random() < 0.3:
        file.write_bytes(bytes_damaged(file.read_bytes(), dice))
        return
    if dice.random() < 0.15:
        beside = dice.choice([p for p in path.rglob("*") if p.is_file() and p != file])
        beside.write_bytes(bytes_damaged(beside.read_bytes() or b"x", dice))
        return
    with h5py.File(file, "r+") as h5:
        names: list[str] = []
        h5.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        name, way = dice.choice(names), dice.randrange(6)
        values = h5[name][()]
        if way == 0:
            attribute = dice.choice([*h5.attrs])
            del h5.attrs[attribute]
        elif way == 1:
            attribute = dice.choice([*h5.attrs])
            h5.attrs[attribute] = dice.choice((-1, "x", np.nan, [1, 2], ""))
        elif way == 2:
            del h5[name]
        elif way == 3:
            del h5[name]
            h5[name] = dice.choice((np.zeros(0), np.zeros((1, 1, 1)), "x", 3.0, np.ravel(values)[:3]))
        else:
            if np.issubdtype(values.dtype, np.floating) and values.size:
                flat = np.ravel(values).copy()
                flat[dice.randrange(flat.size)] = dice.choice((np.nan, np.inf, -1e300, 0.0))
                h5[name][...] = flat.reshape(values.shape) if dice.random() < 0.5 else np.nan


def grounds(kind: str, folder: Path, more: Path | None) -> list[Path]:
    """Make the files that are damaged."""
    rng = np.random.default_rng(1)
    made: list[Path] = []
    if kind == "study":
        for name in warpwear.studies().entries:
            made.append(folder / f"{name}.toml")
            made[-1].write_text(warpwear.Study.load(name).to_toml())
        for name in RIGS:
            made.append(folder / f"draft-{name}.toml")
            warpwear.new_study(made[-1], like=name)
    elif kind == "surface":
        heights = rng.normal(size=(48, 64)) * 0.1
        made = [folder / "map.npy", folder / "map.csv", folder / "map.xyz"]
        np.save(made[0], heights)
        np.savetxt(made[1], heights, delimiter=",")
        y, x = np.indices(heights.shape)
        np.savetxt(made[2], np.column_stack((x.ravel(), y.ravel(), heights.ravel())))
    elif kind == "record":
        s = np.linspace(0.0, 600.0, 400)
        cof = 0.6 - 0.3 * np.exp(-s / 80.0) + 0.01 * rng.normal(size=s.size)
        made = [folder / "forces.csv", folder / "cof.txt"]
        rows = zip(s, 5.0 + 0 * s, 5.0 * cof, strict=True)
        head = "Time [s],Normal force [N],Friction force [N]\n"
        made[0].write_text(head + "".join(f"{a:.3f},{b:.4f},{c:.4f}\n" for a, b, c in rows))
        made[1].write_text(
            "distance [m]\tCOF\n" + "".join(f"{a:.3f}\t{c:.4f}\n" for a, c in zip(s, cof, strict=True))
        )
    else:
        small = {"grid.cell": "20 um", "sliding.distance": "2 mm"}
        for name in ("v3-fine", "track"):
            made.append(folder / name)
            far = {"sliding.distance": "4 mm", "grid.cell": "20 um"} if name == "track" else small
            study = warpwear.Study.load(name).replace(far | {"output.snapshots": ["1 mm"]})
            warpwear.run(study, out=made[-1], plots=False, threads=1).close()
    if more is not None:
        fits = SUFFIXES.get(kind, ())
        made += sorted(
            p for p in more.rglob("*") if p.suffix.lower() in fits and p.stat().st_size < 4_000_000
        )
    return made


def digests(folder: Path) -> dict[str, str]:
    """Return the digests of all files below a folder."""
    files = sorted(p for p in folder.rglob("*") if p.is_file())
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


@contextlib.contextmanager
def patient(seconds: int) -> Iterator[None]:
    """Raise TimeoutError after so many seconds."""

    def late(*_: object) -> None:
        raise TimeoutError(f"still working after {seconds} s")

    signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)


def ended(arguments: list[str], patience: int) -> tuple[int | None, str]:
    """Run a command in this process; return its status and what it wrote to the error stream."""
    out, err = io.StringIO(), io.StringIO()
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), patient(patience):
            command_line(arguments)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1, err.getvalue()
    except BaseException:
        return None, traceback.format_exc()
    return 0, err.getvalue()


def fault(status: int | None, said: str) -> str:
    """Say what is wrong with how a command ended; empty, if nothing is."""
    if status is None:
        return said
    if status not in (0, 1, 2) or "Traceback" in said:
        return f"status {status}: {said[-2000:]}"
    lines = [line for line in said.splitlines() if line.startswith("warpwear: ")]
    if status == 2 and len(lines) != 1 and "Usage:" not in said:
        return f"status 2 with {len(lines)} sentences: {said[-2000:]}"
    return ""


def try_one(
    kind: str, ground: Path, dice: random.Random, patience: int, beside: Path
) -> tuple[str, int | None, str]:
    """Damage a file, run a command on it; return the command, its status and what is wrong."""
    damage: Callable[[bytes, random.Random], bytes]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        shutil.copytree(beside, folder, dirs_exist_ok=True)
        target = folder / f"damaged{ground.suffix}"
        if kind == "result":
            shutil.copytree(ground, target)
            with contextlib.suppress(OSError, KeyError):  # what HDF5 itself does not let be damaged
                result_damaged(target, dice)
        else:
            table = ground.suffix.lower() in (".csv", ".txt", ".xyz", ".asc")
            damage = study_damaged if kind == "study" else table_damaged if table else bytes_damaged
            target.write_bytes(damage(ground.read_bytes(), dice))
        command = [part.format(target.name) for part in dice.choice(COMMANDS[kind])]
        before = digests(folder)
        with contextlib.chdir(folder):
            status, said = ended(command, patience)
        after = digests(folder)
        kept = {name for name in before if kind != "result" or not name.startswith(target.name)}
        gone = sorted(name for name in kept if after.get(name) != before[name])
        wrong = fault(status, said) or (f"changed or gone: {', '.join(gone)}" if gone else "")
        if wrong and kind != "result":
            keep = Path(
                tempfile.gettempdir(),
                f"fault-{kind}-{hashlib.sha256(wrong.encode()).hexdigest()[:8]}{ground.suffix}",
            )
            keep.write_bytes(target.read_bytes())
            wrong += f"\nkept as {keep}"
    return " ".join(command), status, wrong


def main() -> None:
    """Exit status 1 if a case ended wrongly."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--kind", choices=COMMANDS, required=True)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--patience", type=int, default=60, help="seconds a command may take")
    parser.add_argument("--more", type=Path, help="a folder with files of one's own")
    parser.add_argument("--shard", default="0/1", metavar="k/n", help="which part of how many")
    options = parser.parse_args()
    shard, shards = map(int, options.shard.split("/"))
    warnings.simplefilter("ignore")
    statuses, faults = dict[str, int](), dict[str, list[str]]()
    with tempfile.TemporaryDirectory() as place:
        made = Path(place, "made")
        made.mkdir()
        grounds_ = grounds(options.kind, made, options.more)
        beside = Path(place, "beside")
        beside.mkdir()
        (beside / "notes.txt").write_text("a user's own\n")
        if options.kind == "record":
            shutil.copy(made / "forces.csv", beside / "mine.csv")
        if options.kind == "result":
            shutil.copytree(made / "v3-fine", beside / "mine")
        for case in range(shard, options.cases, shards):
            dice = random.Random(f"{options.kind}, {options.seed}, {case}")
            ground = dice.choice(grounds_)
            command, status, wrong = try_one(options.kind, ground, dice, options.patience, beside)
            name = f"{command.split()[0]} {status}"
            statuses[name] = statuses.get(name, 0) + 1
            if wrong:
                told = [line for line in wrong.splitlines() if line.strip() and "kept as" not in line]
                what = told[-1]
                faults.setdefault(what[:200], []).append(f"case {case}, {ground.name}: {command}\n{wrong}")
    for what, cases in faults.items():
        print(f"== {len(cases)} x {what}\n{cases[0]}\n", flush=True)
    wrong_ones = sum(map(len, faults.values()))
    ways = ", ".join(f"{name}: {statuses[name]}" for name in sorted(statuses))
    print(f"{options.kind}: {sum(statuses.values())} cases ({ways}), {wrong_ones} wrong, {len(faults)} kinds")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
