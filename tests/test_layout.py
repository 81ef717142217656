"""The house keeps its rules: what lies where, what imports where, how long a signature may be."""

import ast
import io
import re
import tokenize
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from warpwear.version import __version__

ROOT = Path(__file__).parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
#: Folders of what is installed, and of what is not.
PRODUCT, BESIDE = ("warpwear", "kernels", "surfaces"), ("bench", "tests")
#: Most bare lines of what is installed, Python and C++ together: a feature more is a line less elsewhere.
MOST_LINES = 44_599
#: Tokens of Python that no line is counted for.
BLANK = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}
#: Most files in a folder, `__init__.py` aside, and most parameters of a function.
MOST_FILES, MOST_PARAMETERS = 20, 10
#: Functions that may have more parameters, and why; the list may only become shorter.
LONG = {
    "warpwear/contact/array/solve.py: solve_contact": "each is a number of the contact that is named",
}
Function = ast.FunctionDef | ast.AsyncFunctionDef


def functions_in(tree: ast.AST, prefix: str = "") -> Iterator[tuple[str, Function]]:
    """Every function of a file with its dotted name, those of classes and within functions included."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, Function):
            yield prefix + node.name, node
        inner = f"{prefix}{node.name}." if isinstance(node, Function | ast.ClassDef) else prefix
        yield from functions_in(node, inner)


# Each is read when a test asks for it: every process that runs tests imports this file.


@cache
def files() -> dict[str, ast.Module]:
    """What every file says, by its path in the checkout."""
    return {
        path.relative_to(ROOT).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
        for top in (*PRODUCT, *BESIDE)
        for path in sorted((ROOT / top).rglob("*.py"))
    }


@cache
def installed() -> dict[str, ast.Module]:
    """Those of the files that are installed."""
    return {name: tree for name, tree in files().items() if name.startswith(PRODUCT)}


@cache
def functions() -> dict[str, list[tuple[str, Function]]]:
    """Every function of what is installed with its dotted name, by file."""
    return {name: list(functions_in(tree)) for name, tree in installed().items()}


def bare_lines(path: Path) -> int:
    """Lines with a token of Python other than docstrings, or of a header neither blank nor comment."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".h":
        code = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL)
        return sum(bool(line.strip()) for line in code.splitlines())
    counted: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in BLANK:
            counted.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | Function) and ast.get_docstring(node) is not None:
            counted.difference_update(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    return len(counted)


def is_command(function: Function) -> bool:
    """Whether click calls it: its parameters are the options of a command."""
    decorators = [ast.unparse(decorator) for decorator in function.decorator_list]
    return any(re.search(r"\bcommand\(", text) for text in decorators)


def test_every_package_is_installed() -> None:
    setuptools = PYPROJECT["tool"]["setuptools"]
    folders = {Path(name).parent.as_posix().replace("/", ".") for name in installed()}
    folders = {name if name.startswith("warpwear") else f"warpwear.{name}" for name in folders}
    assert folders | set(setuptools["package-data"]) == set(setuptools["packages"])


def test_the_product_does_not_grow() -> None:
    """Bare lines by wing, printed where they are too many, or with `pytest -rP`."""
    counts: dict[str, int] = {}
    for top in PRODUCT:
        for path in sorted((ROOT / top).rglob("*.py")) + sorted((ROOT / top).rglob("*.h")):
            wing = "/".join(path.relative_to(ROOT).parts[:2]) if top == "warpwear" else top
            counts[wing] = counts.get(wing, 0) + bare_lines(path)
    total = sum(counts.values())
    print(f"{total} bare lines:", ", ".join(f"{wing} {count}" for wing, count in counts.items()))
    assert total <= MOST_LINES


def test_no_folder_is_full() -> None:
    folders = {ROOT / "kernels" / "native", *((ROOT / name).parent for name in files())}
    counts = {
        folder.relative_to(ROOT).as_posix(): sum(
            path.is_file() and path.name != "__init__.py" for path in folder.iterdir()
        )
        for folder in folders
    }
    full = {name: count for name, count in counts.items() if count > MOST_FILES}
    assert not full, f"more than {MOST_FILES} files: {full}"


def test_signatures_are_short() -> None:
    long = {}
    for name, found_in in functions().items():
        for dotted, function in found_in:
            given = function.args
            count = len(given.posonlyargs + given.args + given.kwonlyargs)
            count -= bool(given.args) and given.args[0].arg in ("self", "cls")
            if count > MOST_PARAMETERS and not is_command(function):
                long[f"{name}: {dotted}"] = count
    found = [f"{function} has {count}" for function, count in long.items() if function not in LONG]
    assert not found, f"more than {MOST_PARAMETERS} parameters:\n" + "\n".join(found)
    assert set(LONG) <= set(long), "a function that has become short leaves the list LONG"


def test_a_class_name_stands_for_one_class() -> None:
    """Of what is installed, classes within functions and classes included."""
    places: dict[str, list[str]] = {}
    for path, tree in installed().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                places.setdefault(node.name, []).append(f"{path}:{node.lineno}")
    twins = {name: where for name, where in places.items() if len(where) > 1}
    assert not twins, f"names of more than one class: {twins}"


def test_kernels_are_launched_by_programs() -> None:
    found = [
        name
        for name, tree in installed().items()
        if name != "warpwear/engine/program.py"
        and any(
            isinstance(node, ast.Attribute) and node.attr == "launch" and ast.unparse(node.value) == "wp"
            for node in ast.walk(tree)
        )
    ]
    assert not found, f"launch kernels themselves: {found}"


def test_wings_import_nothing_by_themselves() -> None:
    """All but `warpwear/__init__.py`, which gives the public names."""
    inits = [name for name in installed() if name.endswith("__init__.py") and name != "warpwear/__init__.py"]
    assert inits
    for name in inits:
        assert ast.get_docstring(files()[name]), f"{name} says nothing"
        imports = [node for node in ast.walk(files()[name]) if isinstance(node, ast.Import | ast.ImportFrom)]
        assert not imports, f"{name} imports something"


def test_nothing_of_ours_is_imported_inside_functions() -> None:
    """Slow packages of others are late by `lazy.module`; ours only in the tables of names."""
    found = [
        f"{name}: line {node.lineno}"
        for name, found_in in functions().items()
        for _, function in found_in
        for node in ast.walk(function)
        if isinstance(node, ast.Import | ast.ImportFrom)
    ]
    assert not found, "imports inside functions:\n" + "\n".join(found)


def test_nobody_imports_the_face_of_the_package() -> None:
    """`import warpwear` would import downwards and upwards at once; modules import each other."""
    allowed = {"lazy"}  # `from warpwear import lazy`
    found = [
        f"{name}: line {node.lineno}"
        for name, tree in installed().items()
        for node in ast.walk(tree)
        if (isinstance(node, ast.Import) and any(alias.name == "warpwear" for alias in node.names))
        or (
            isinstance(node, ast.ImportFrom)
            and node.module == "warpwear"
            and not {alias.name for alias in node.names} <= allowed
        )
    ]
    assert not found, "imports of the package itself:\n" + "\n".join(found)


def test_test_files_do_not_import_each_other() -> None:
    found = [
        f"{name}: line {node.lineno}"
        for name, tree in files().items()
        if name.startswith("tests/")
        for node in ast.walk(tree)
        if (isinstance(node, ast.ImportFrom) and (node.module or "").startswith("test_"))
        or (isinstance(node, ast.Import) and any(alias.name.startswith("test_") for alias in node.names))
    ]
    assert not found, "cases that tests share belong into tests/cases_*.py:\n" + "\n".join(found)
    assert PYPROJECT["tool"]["pytest"]["ini_options"]["pythonpath"] == ["tests"]


def test_the_page_for_contributors_lists_the_wings_from_the_roof_to_the_ground() -> None:
    told = [
        re.findall(r"`(\w+)`", line.partition(":")[0])
        for line in CONTRIBUTING.splitlines()
        if line[:3] == "- `"
    ]
    (layers,) = (c["layers"] for c in PYPROJECT["tool"]["importlinter"]["contracts"] if "layers" in c)
    assert told == [layer.split(" | ") for layer in layers]


def test_the_page_for_contributors_is_true() -> None:
    """Every path that it names is there."""
    named = re.findall(r"`((?:[\w.*-]+/)+[\w.*-]*|[\w-]+\.(?:md|toml))`", CONTRIBUTING)
    assert len(named) > 20
    sections = {"contact.py", "motion.py", "settings.py"}  # of warpwear/study/, as the table says
    gone = [name for name in {*named} if not (any(ROOT.glob(name)) or name in sections)]
    assert not gone, f"CONTRIBUTING.md names what is not there: {sorted(gone)}"


def test_the_version_is_told_once() -> None:
    """By warpwear/version.py, which the build reads; the citation repeats it."""
    assert PYPROJECT["project"]["dynamic"] == ["version"]
    assert PYPROJECT["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "warpwear.version.__version__"}
    assert f"\nversion: {__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_the_conda_recipe_asks_for_what_the_wheel_asks_for() -> None:
    recipe = (ROOT / ".ci" / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    assert f'version: "{__version__}"' in recipe
    asked = re.findall(r"^    - ([\w-]+) (>=[\d.]+)$", recipe.partition("  run:")[2], re.MULTILINE)
    names = {"matplotlib-base": "matplotlib"}  # conda-forge's matplotlib brings Qt
    project = PYPROJECT["project"]
    wanted = [f"python{project['requires-python']}", *project["dependencies"]]
    assert [names.get(name, name) + version for name, version in asked] == wanted
