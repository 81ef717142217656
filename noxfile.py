"""Tasks of development and of continuous integration: `nox -l` lists them, `nox -s docs` runs one.

Each has an environment of its own. `.ci/run` makes one for all, and runs its tasks there with
`nox --no-venv`.
"""

import os
import re
import shlex
import shutil
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import nox

nox.options.sessions = ["lint", "tests"]
ROOT = Path(__file__).parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
README = (ROOT / "README.md").read_text(encoding="utf-8")
QUICK = ("-n", "auto", "--dist", "worksteal")
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
#: Something that a page of the site would fetch when it is shown.
FETCHED = re.compile(r'(<script[^>]*src|<link[^>]*rel="(stylesheet|preload)"[^>]*href)="(https?:)?//')


def install(session: nox.Session, *packages: str) -> None:
    """Install into the task's own environment, or into the one that `nox --no-venv` was started in."""
    if isinstance(session.virtualenv, nox.virtualenv.PassthroughEnv):
        session.run("python", "-m", "pip", "install", "--quiet", *packages)
    else:
        session.install(*packages)


def tools(*names: str) -> list[str]:
    """Return the requirements of tools as `pip install ".[dev]"` has them."""
    wanted = PROJECT["optional-dependencies"]["dev"]
    return [one for one in wanted if re.split(r"[<>=~]", one)[0] in names]


def temporary(session: nox.Session) -> Path:
    """Return an empty folder of the task, with an absolute path."""
    folder = Path(session.create_tmp()).absolute()
    shutil.rmtree(folder)
    folder.mkdir()
    return folder


def oldest() -> list[str]:
    """Return the oldest version of each dependency that pyproject.toml allows, as pip's constraints."""
    asked = PROJECT["dependencies"] + PROJECT["optional-dependencies"]["io"]
    return [requirement.replace(">=", "==") for requirement in asked]


def release_notes() -> str:
    """Return what the changelog says of its newest version."""
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    return re.split(r"^## .*$", changelog, flags=re.MULTILINE)[1].strip() + "\n"


@nox.session
def lint(session: nox.Session) -> None:
    """Check style and format."""
    install(session, *tools("ruff", "clang-format"))
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    headers = [str(header) for header in Path("kernels/native").rglob("*.h")]
    session.run("clang-format", "--dry-run", "-Werror", *headers)


@nox.session
def types(session: nox.Session) -> None:
    """Check types and layers of the package as installed, from a folder without the sources."""
    install(session, *tools("mypy", "import-linter"))
    if not isinstance(session.virtualenv, nox.virtualenv.PassthroughEnv):
        session.install(".[io,test]")
    with session.chdir(folder := temporary(session)):
        config = str(ROOT / "pyproject.toml")
        session.run("mypy", "--config-file", config, "--cache-dir", str(folder / "mypy"), "-p", "warpwear")
        session.run("lint-imports", "--config", config, "--no-cache")


@nox.session
def readme(session: nox.Session) -> None:
    """Install and run the tests by the README's second line."""
    (line,) = re.findall(r"^(pip install .* && python -m pytest.*)$", README, re.MULTILINE)
    session.run("bash", "-c", f"{line} {shlex.join(session.posargs)}", external=True)


@nox.session(python=PYTHONS)
def tests(session: nox.Session) -> None:
    """Run the quick tests with the newest dependencies, on every Python that is here."""
    session.install(".[io,test]")
    session.run("python", "-m", "pytest", *QUICK, *session.posargs)


@nox.session
def pages(session: nox.Session) -> None:
    """Check the pages and pictures that scripts write; as a hook of pre-commit with `nox -R`."""
    session.install("-e", ".[io,test]")
    files = ("tests/docs/test_site.py", "tests/study/test_keys_page.py", "tests/history/test_quantities.py")
    session.run("python", "-m", "pytest", "-q", *files)


@nox.session(python="3.11")
def minimum(session: nox.Session) -> None:
    """Run the quick tests with the oldest dependencies that pyproject.toml allows."""
    constraints = Path(session.create_tmp()) / "oldest.txt"
    constraints.write_text("\n".join(oldest()) + "\n", encoding="utf-8")
    session.install("-c", str(constraints), ".[io,test]")
    session.run("python", "-m", "pytest", *QUICK, *session.posargs)


@nox.session
@nox.parametrize("which", ["lowest", "newest"])
def versions(session: nox.Session, which: str) -> None:
    """Run a study that `new` wrote with the lowest, or the newest, packages that pyproject.toml allows.

    The lowest have wheels for the lowest Python; where that is not here there is nothing to run.
    """
    python: Path | None = Path(sys.executable)
    if which == "lowest" and f"{sys.version_info.major}.{sys.version_info.minor}" != PYTHONS[0]:
        python = dict(other_pythons(session)).get(PYTHONS[0])
    if python is None:
        session.skip(f"Python {PYTHONS[0]} is not here")
    shutil.rmtree(ROOT / "build" / "lib", ignore_errors=True)  # what another install left would be packed
    with session.chdir(folder := temporary(session)):
        constraints = folder / "constraints.txt"
        constraints.write_text("\n".join(oldest() if which == "lowest" else []), encoding="utf-8")
        command = installed_in(session, folder / "own", python, ROOT, "--upgrade", "-c", str(constraints))
        session.run(command, "new", "study.toml", "--like", "reciprocating", external=True)
        short = ("--set", "grid.cell=20 um", "--set", "sliding.distance=0.3 mm")
        session.run(command, "run", "study.toml", "--out", "run", *short, external=True)
        for name in ("result.h5", "history.csv", "figures/cof.png"):
            if not (folder / "run" / name).stat().st_size:
                session.error(f"the run left no {name}")


@nox.session
def coverage(session: nox.Session) -> None:
    """Say which lines the quick tests run; kernels are not Python and are left out."""
    session.install("-e", ".[io,test]", "pytest-cov>=7")
    session.run("python", "-m", "pytest", *QUICK, "--cov", "--cov-report=term:skip-covered", *session.posargs)


@nox.session
def docs(session: nox.Session) -> None:
    """Make the site in build/site, with its tutorials and examples run; a page of it fetches nothing."""
    install(session, ".[io,docs,test]")
    session.run(
        "python", "-m", "pytest", "-q", "-m", "slow or not slow", "tests/docs/test_commands_in_python.py"
    )
    site = ROOT / "build" / "site"
    shutil.rmtree(site, ignore_errors=True)
    session.run("python", "-m", "sphinx", "-W", "--keep-going", "-j", "auto", "-q", "docs", str(site))
    if not (site / "searchindex.js").stat().st_size:
        session.error("the site cannot be searched")
    fetching = [str(page) for page in site.rglob("*.html") if FETCHED.search(page.read_text("utf-8"))]
    if fetching:
        session.error(f"these pages load something from the network: {', '.join(fetching)}")


@nox.session
def wheel(session: nox.Session) -> None:
    """Run the wheel in another folder, on this Python and on the others that are here."""
    install(session, *tools("build"))
    folder = temporary(session)
    shutil.rmtree(ROOT / "build" / "lib", ignore_errors=True)  # what another install left would be packed
    session.run("python", "-m", "build", "--quiet", "--wheel", "--outdir", str(folder / "dist"), ".")
    (file,) = (folder / "dist").glob("*.whl")
    with session.chdir(folder):
        command = installed_in(session, folder / "own", Path(sys.executable), file)
        session.run(command, "--version", external=True)
        session.run(command, "studies", external=True)
        coarse = ("run", "v3-fine", "--set", "grid.cell=5 um")
        session.run(command, *coarse, "--out", "run", "--set", "sliding.distance=30 mm", external=True)
        for name in ("result.h5", "history.csv", "figures/cof.png"):
            if not (folder / "run" / name).stat().st_size:
                session.error(f"the run left no {name}")
        session.run(command, "run", "v3", "--set", "contact.load=-8 N", success_codes=[2], external=True)
        for version, python in other_pythons(session):
            command = installed_in(session, folder / version, python, file)
            short = ("--out", f"on-{version}", "--no-plots", "--set", "sliding.distance=3 mm")
            session.run(command, *coarse, *short, external=True)
            session.run(command, "plot", f"on-{version}", "--only", "cof", external=True)


def installed_in(session: nox.Session, place: Path, python: Path, file: Path, *options: str) -> str:
    """Install a wheel or sources into a new environment of a Python; return the path of its command."""
    session.run(str(python), "-m", "venv", str(place), external=True)
    pip = (str(place / "bin" / "python"), "-m", "pip", "install", "--quiet")
    session.run(*pip, *options, str(file), external=True)
    return str(place / "bin" / "warpwear")


def other_pythons(session: nox.Session) -> Iterator[tuple[str, Path]]:
    """Yield each other version of Python that is here, with its program."""
    versions = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    for version in PYTHONS:
        if version == f"{sys.version_info.major}.{sys.version_info.minor}":
            continue
        programs = [shutil.which(f"python{version}"), *versions.glob(f"{version}.*/bin/python")]
        asks = f"import sys, venv; print(sys.version_info[:2] == {tuple(map(int, version.split('.')))})"
        for program in filter(None, programs):
            answer = session.run(
                str(program), "-c", asks, external=True, silent=True, log=False, success_codes=[*range(256)]
            )
            if str(answer).strip() == "True":
                yield version, Path(program)
                break
        else:
            session.log(f"Python {version} is not here")


@nox.session
def links(session: nox.Session) -> None:
    """Look whether the site's links to other places still lead somewhere; needs the network."""
    session.install(".[io,docs]")
    session.run("python", "-m", "sphinx", "-b", "linkcheck", "docs", "build/links")


@nox.session
def distribution(session: nox.Session) -> None:
    """Build wheel and sdist, check what is in them, and write the release notes beside them."""
    session.install("build>=1.2", "twine>=6", "check-wheel-contents>=0.6")
    session.run("python", "-m", "build", "--outdir", "build/dist", ".")
    files = [str(file) for file in Path("build/dist").glob("warpwear-*")]
    session.run("twine", "check", "--strict", *files)
    session.run("check-wheel-contents", *(file for file in files if file.endswith(".whl")))
    Path("build/dist/release-notes.md").write_text(release_notes(), encoding="utf-8")


@nox.session
def conda(session: nox.Session) -> None:
    """Render the conda recipe, which finds what is wrong in it; `-- build` builds it from conda-forge."""
    session.install("py-rattler-build>=0.70")
    script = "from rattler_build import Stage0Recipe, VariantConfig as V; "
    script += "r = Stage0Recipe.from_file('.ci/conda/recipe.yaml').render(V()); print(r[0].recipe.to_dict())"
    if "build" in session.posargs:
        script += "; r[0].run_build(channels=['conda-forge'], output_dir='build/conda')"
    session.run("python", "-c", script)
