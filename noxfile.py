"""Tasks of development: `nox -l` lists them, `nox -s docs` runs one, each in an environment of its own."""

import re
import tomllib
from pathlib import Path

import nox

nox.options.sessions = ["lint", "tests"]
ROOT = Path(__file__).parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
QUICK = ("-n", "auto", "--dist", "loadfile")


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
    session.install("ruff>=0.12", "clang-format>=23.1,<23.2")
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    headers = [str(header) for header in Path("kernels/native").rglob("*.h")]
    session.run("clang-format", "--dry-run", "-Werror", *headers)


@nox.session(python=["3.11", "3.12", "3.13", "3.14"])
def tests(session: nox.Session) -> None:
    """Run the quick tests with the newest dependencies, on every Python that is here."""
    session.install(".[io,test]")
    session.run("python", "-m", "pytest", *QUICK, *session.posargs)


@nox.session(python="3.11")
def minimum(session: nox.Session) -> None:
    """Run the quick tests with the oldest dependencies that pyproject.toml allows."""
    constraints = Path(session.create_tmp()) / "oldest.txt"
    constraints.write_text("\n".join(oldest()) + "\n", encoding="utf-8")
    session.install("-c", str(constraints), ".[io,test]")
    session.run("python", "-m", "pytest", *QUICK, *session.posargs)


@nox.session
def coverage(session: nox.Session) -> None:
    """Say which lines the quick tests run; kernels are not Python and are left out."""
    session.install("-e", ".[io,test]", "pytest-cov>=7")
    session.run("python", "-m", "pytest", *QUICK, "--cov", "--cov-report=term:skip-covered", *session.posargs)


@nox.session
def docs(session: nox.Session) -> None:
    """Make the site in build/site."""
    session.install(".[io,docs]")
    session.run("python", "-m", "sphinx", "-W", "-j", "auto", "docs", "build/site")


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
