"""The one writer of folders of reports: figures, a page that shows them, tables; all of them or none."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

from warpwear.figures import style
from warpwear.figures.describe import Figure
from warpwear.figures.paint import paint
from warpwear.results import manifest
from warpwear.results.folder import whole_folder

#: What a file holds, or what writes it at a path.
Content: TypeAlias = str | bytes | Callable[[Path], object]
#: What makes the page of the pictures, PNG files by the figure's name.
Page: TypeAlias = Callable[[Mapping[str, bytes]], str | bytes]


def write_report(
    folder: Path,
    figures: Mapping[str, Figure],
    *,
    pages: Mapping[str, Page] = MappingProxyType({}),
    files: Mapping[str, Content] = MappingProxyType({}),
    marks: Sequence[str] = (),
    within: str = "",
    file_format: str = "png",
    older: Iterable[str] = (),
) -> list[Path]:
    """Write a report into a folder; return the paths, those of `marks` last. Raises InputError.

    pages, files: by name. marks: names of files that show that a folder is whole. within: the folder of
    figures inside it. file_format: of `style.FORMATS`. older: names of figures of an older report, which go.
    With marks a manifest says what is written: other files of these names are kept under another one.
    """
    pictures = {name: style.bytes_of(paint(figure)) for name, figure in figures.items()}
    ours = manifest.written(folder) if marks else set()
    stale = [f"{name}.{kind}" for name in older for kind in style.FORMATS if f"{name}.{kind}" in ours]
    with ExitStack() as stack:
        work = stack.enter_context(whole_folder(folder, marks, stale=[] if within else stale))
        drawings = stack.enter_context(whole_folder(folder / within, (), stale=stale)) if within else work
        for name, figure in figures.items():
            is_png = file_format == "png"
            drawn = pictures[name] if is_png else style.bytes_of(paint(figure), file_format)
            (drawings / f"{name}.{file_format}").write_bytes(drawn)
        for name, content in {**files, **{name: make(pictures) for name, make in pages.items()}}.items():
            _write(work / name, content)
        if marks:
            manifest.write(work, (path.name for path in work.iterdir()))
            for path in work.iterdir():
                if path.name not in ours:
                    manifest.set_aside(folder / path.name)
        names = sorted((path.name for path in work.iterdir()), key=lambda name: (name in marks, name))
        inside = sorted(f"{within}/{path.name}" for path in drawings.iterdir()) if within else []
    return [folder / name for name in [*inside, *names]]


def _write(path: Path, content: Content) -> None:
    if callable(content):
        content(path)
    else:
        path.write_bytes(content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content)
