"""Folders of sweeps that others were in: no file of theirs is touched, and no row is wrong."""

import ctypes
import shutil
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from cases_sweeps import small
from fuzzing import check_sentence

import warpwear
from warpwear import InputError
from warpwear.batches.batch import RUNS
from warpwear.engine.workers import Here
from warpwear.results import manifest
from warpwear.results.file import FILE_NAME
from warpwear.results.folder import LOCK
from warpwear.runs.checkpoint import FILE_NAME as CHECKPOINT
from warpwear.sweeps.report import PAGE
from warpwear.sweeps.table import TABLES

MINE = b"mine: nobody else may change this\n" * 9
VARY = {"contact.load": ["4 N", "8 N"]}
#: Capabilities of root that no permission holds back: to override them, and to search and read.
OVERRIDE = 1 << 1 | 1 << 2


@contextmanager
def without_privileges() -> Iterator[None]:
    """Let permissions hold for this thread of root, too."""
    libc = ctypes.CDLL(None)
    header, before = (ctypes.c_uint32 * 2)(0x20080522, 0), (ctypes.c_uint32 * 6)()
    libc.capget(header, before)
    less = (ctypes.c_uint32 * 6)(*before)
    less[0] &= ~OVERRIDE & 0xFFFFFFFF
    libc.capset(header, less)
    try:
        yield
    finally:
        libc.capset(header, before)


def swept(out: Path) -> Any:
    return warpwear.sweep(small(), vary=VARY, out=out, executor=Here())


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory, quick_pictures: Any) -> tuple[Path, dict[str, Any]]:
    """A folder of a sweep, and its table."""
    out = tmp_path_factory.mktemp("sweeps") / "s"
    with quick_pictures(blank=True):
        return out, swept(out).table


def run_of(out: Path, number: int = 0) -> Path:
    return sorted(path for path in (out / RUNS).iterdir() if path.is_dir())[number]


def files_of_mine(place: Path) -> int:
    files = (path for path in place.rglob("*") if path.is_file() and not path.is_symlink())
    return sum(path.read_bytes() == MINE for path in files)


def remove(path: Path) -> None:
    shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink(missing_ok=True)


def foreign(name: str) -> Callable[[Path, Path], None]:
    """A file of another program where the sweep has one; the manifest does not know it."""

    def put(out: Path, mine: Path) -> None:
        manifest.write(out, manifest.written(out) - {name})
        (out / name).write_bytes(MINE)

    return put


def link(name: str) -> Callable[[Path, Path], None]:
    """A link to a file of the user's."""

    def put(out: Path, mine: Path) -> None:
        path = (
            out / name if "RUN" not in name else Path(str(out / RUNS / name).replace("RUN", run_of(out).name))
        )
        remove(path)
        path.symlink_to(mine)

    return put


def folder(name: str) -> Callable[[Path, Path], None]:
    """A folder of the user's with a file in it."""

    def put(out: Path, mine: Path) -> None:
        path = (
            out / name if "RUN" not in name else Path(str(out / RUNS / name).replace("RUN", run_of(out).name))
        )
        remove(path)
        path.mkdir()
        (path / "notes.txt").write_bytes(MINE)

    return put


def content(name: str, change: Callable[[bytes], bytes]) -> Callable[[Path, Path], None]:
    """Other bytes in a file of the sweep."""

    def put(out: Path, mine: Path) -> None:
        path = (
            out / name if "RUN" not in name else Path(str(out / RUNS / name).replace("RUN", run_of(out).name))
        )
        path.write_bytes(change(path.read_bytes() if path.exists() else b""))

    return put


def mode(name: str, bits: int) -> Callable[[Path, Path], None]:
    """Permissions that do not do."""

    def put(out: Path, mine: Path) -> None:
        path = (
            out / name if "RUN" not in name else Path(str(out / RUNS / name).replace("RUN", run_of(out).name))
        )
        path.chmod(bits)

    return put


def other_run(out: Path, mine: Path) -> None:
    shutil.copy(run_of(out, 1) / FILE_NAME, run_of(out, 0) / FILE_NAME)


def run_is_file(out: Path, mine: Path) -> None:
    path = run_of(out)
    remove(path)
    path.write_bytes(MINE)


def run_is_link(out: Path, mine: Path) -> None:
    path = run_of(out)
    remove(path)
    (mine.parent / "d").mkdir()
    (mine.parent / "d" / "notes.txt").write_bytes(MINE)
    path.symlink_to(mine.parent / "d")


def figures_are_linked(out: Path, mine: Path) -> None:
    remove(out / manifest.FIGURES)
    (mine.parent / "d").mkdir()
    (mine.parent / "d" / "courses.png").write_bytes(MINE)
    (out / manifest.FIGURES).symlink_to(mine.parent / "d")


FIGURE = f"{manifest.FIGURES}/courses.png"
RESULT = f"RUN/{FILE_NAME}"
#: What is done to a finished sweep, given its folder and a file of the user's elsewhere.
CASES: dict[str, Callable[[Path, Path], None]] = {
    **{f"foreign {name}": foreign(name) for name in (*TABLES, PAGE, FIGURE)},
    "foreign file in a run": content("RUN/notes.txt", lambda _: MINE),
    "foreign page in a run": content("RUN/report.html", lambda _: MINE),
    "foreign file in runs": content(f"{RUNS}/notes.txt", lambda _: MINE),
    **{
        f"{name} is a link": link(name)
        for name in (*TABLES, PAGE, FIGURE, manifest.NAME, LOCK, "RUN.lock", RESULT, "RUN/log.txt")
    },
    f"RUN/{manifest.NAME} is a link": link(f"RUN/{manifest.NAME}"),
    f"RUN/{LOCK} is a link": link(f"RUN/{LOCK}"),
    "run is a link": run_is_link,
    "figures are a link": figures_are_linked,
    **{
        f"{name} is a folder": folder(name)
        for name in (TABLES[0], PAGE, FIGURE, manifest.NAME, LOCK, RESULT, "RUN.lock", f"RUN/{CHECKPOINT}")
    },
    "run is a file": run_is_file,
    "run is of another": other_run,
    "figures are a file": lambda out, mine: (remove(out / "figures"), (out / "figures").write_bytes(MINE))[0],
    "runs are a file": lambda out, mine: (remove(out / RUNS), (out / RUNS).write_bytes(MINE))[0],
    **{f"table cut at {n}": content(TABLES[0], lambda b, n=n: b[:n]) for n in (0, 40, 700, 900)},
    "table of another": content(TABLES[0], lambda b: b + b"0123,done,1.0\n"),
    "table of noughts": content(TABLES[0], lambda b: bytes(len(b))),
    "table with a mark": content(TABLES[0], lambda b: b"\xef\xbb\xbf" + b),
    **{f"result cut at {n}": content(RESULT, lambda b, n=n: b[:n]) for n in (0, 100, 9_000)},
    "result of noughts": content(RESULT, lambda b: bytes(len(b))),
    "a bit of the result": content(RESULT, lambda b: b[:9_000] + bytes([b[9_000] ^ 4]) + b[9_001:]),
    "foreign checkpoint": content(f"RUN/{CHECKPOINT}", lambda _: b"\x89HDF" * 99),
    **{
        f"{name} is {bits:o}": mode(name, bits)
        for name, bits in (
            (".", 0o555),
            (RUNS, 0o555),
            (RUNS, 0o000),
            ("RUN", 0o555),
            ("RUN", 0o000),
            (RESULT, 0o000),
            (TABLES[0], 0o000),
            (manifest.NAME, 0o000),
            (manifest.FIGURES, 0o555),
        )
    },
}
QUICK = ("foreign sweep.nc", "run is of another", f"{LOCK} is a link", "RUN is 0")


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[] if case in QUICK else [pytest.mark.slow]) for case in CASES]
)
def test_a_folder_that_others_were_in(
    case: str, finished: tuple[Path, dict[str, Any]], tmp_path: Path, quick_pictures: Any
) -> None:
    """The sweep goes on to the same rows, or says in one sentence why not; a run that fails says so."""
    source, table = finished
    out, mine = tmp_path / "s", tmp_path / "mine.txt"
    shutil.copytree(source, out)
    mine.write_bytes(MINE)
    CASES[case](out, mine)
    count = files_of_mine(tmp_path)
    ended = ""
    try:
        with warnings.catch_warnings(), quick_pictures(blank=True), without_privileges():
            warnings.simplefilter("ignore")
            again = swept(out).table
        failed = [row.startswith("failed: ") for row in again["status"]]
        for name, values in table.items():
            for value, new, is_failed in zip(values, again.get(name, [None] * 2), failed, strict=True):
                assert is_failed or name == "seconds" or value == new or (value != value and new != new), name
        print(case, [status[:150] for status in again["status"]])
    except InputError as error:
        check_sentence(error)
        ended = str(error)
        print(case, ended)
    finally:
        for path in (out, out / RUNS, *(out / RUNS).glob("*"), *out.glob("*"), *out.glob("runs/*/*")):
            with suppress(OSError):
                path.chmod(0o755)
    if case.startswith(("RUN", "run is", "runs is", "result", "foreign checkpoint")):
        assert not ended  # runs fail alone
    assert mine.read_bytes() == MINE
    assert files_of_mine(tmp_path) == count
    assert not [*out.rglob(".tables-*"), *out.rglob(".work-*")]
