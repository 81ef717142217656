"""How Sphinx makes the site: `python -m sphinx -W -j auto docs build/site`, from the root of a checkout.

The site documents the checkout that it lies in, installed or not, and needs no network, built or read.
"""

import os
import stat
import sys
from pathlib import Path

from jupyter_cache.cache.main import JupyterCacheBase

DOCS = Path(__file__).parent
ROOT = DOCS.parent
sys.path[:0] = [str(ROOT), str(DOCS / "extensions")]

from warpwear.version import __version__  # noqa: E402

project = "warpwear"
author = copyright = "the warpwear developers"
version = release = __version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_click",
    "sphinx_design",
    "sphinx_copybutton",
    "mathml",
    "arguments",
    "gallery",
    "streams",
    "outputs",
]
default_role = "code"
source_suffix = {".md": "myst-nb"}
exclude_patterns = ["build", "extensions", "files"]
nitpicky = True
# Types that autodoc meets in signatures and that have no page here.
nitpick_ignore_regex = [("py:.*", r".*")]

html_theme = "furo"
html_title = f"warpwear {__version__}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_search_scorer = str(DOCS / "static" / "scorer.js")
html_show_search_summary = False  # browsers do not let pages from the file system read each other
html_math_renderer = "mathml"
copybutton_prompt_text = "$ "
napoleon_google_docstring = False  # sections of docstrings are those of numpydoc
autodoc_typehints = "signature"
autodoc_member_order = "bysource"
python_maximum_signature_line_length = 88

myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence", "attrs_inline", "substitution"]
myst_heading_anchors = 4
myst_dmath_double_inline = True

# Pages with cells are run when they are read, each in an empty folder, and kept until their cells change.
# Pages are executed side by side: one that thins the cache out takes the record that another has just made,
# whose file is not there yet, for an old one.
JupyterCacheBase.truncate_caches = lambda self: None
nb_execution_mode = "cache"
nb_execution_cache_path = str(ROOT / "build" / "site-cache" / "pages")
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 240
nb_merge_streams = True
nb_ipywidgets_js: dict[str, dict[str, str]] = {}

gallery_cache = str(ROOT / "build" / "site-cache" / "examples")


def _command() -> Path:
    """Make a folder with a command `warpwear` that runs this checkout, and return it."""
    folder = ROOT / "build" / "site-cache" / "bin"
    folder.mkdir(parents=True, exist_ok=True)
    command = folder / "warpwear"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m warpwear "$@"\n')
    command.chmod(command.stat().st_mode | stat.S_IXUSR)
    return folder


def _gpu() -> bool:
    import warp

    return bool(warp.get_cuda_device_count())


# What cells and examples see.
os.environ["PATH"] = os.pathsep.join([str(_command()), os.environ.get("PATH", "")])
os.environ["PYTHONPATH"] = os.pathsep.join(
    [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "verification"), os.environ.get("PYTHONPATH", "")]
)
os.environ["WARPWEAR_DOCS"] = str(DOCS)
os.environ["MPLCONFIGDIR"] = str(ROOT / "build" / "site-cache" / "matplotlib")  # nobody's own settings

has_gpu = _gpu()
nb_execution_excludepatterns = [] if has_gpu else ["tutorials/gpu.md"]
myst_substitutions = {
    "gpu_note": "The cells below were run on a GPU when this page was made."
    if has_gpu
    else "This page was made on a machine without a GPU: the cells below were **not** run."
}
