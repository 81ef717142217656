"""Fill the forms of `templates/`: pages, paragraphs, LaTeX, XML of other software."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from warpwear import lazy

jinja2 = lazy.module("jinja2")

TEMPLATES, KINDS = Path(__file__).parents[2] / "templates", ("pages", "texts", "formats")


def filled(
    form: str, filters: Mapping[str, Any] = MappingProxyType({}), *, escape: bool = True, **content: Any
) -> str:
    """Fill a form; what is put in is escaped, unless the form is plain text. A missing name is an error.

    form: name of its file. filters: name in the form -> function. content: name in the form -> value.
    """
    environment = _environment(form, escape)
    environment.filters.update(filters)
    return environment.get_template(form).render(content)


@cache
def _environment(form: str, escape: bool) -> Any:
    """Keep what a form is compiled into, which takes longer than filling it; its filters are its own."""
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader([TEMPLATES / kind for kind in KINDS]),
        autoescape=escape,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


@cache
def _expression(text: str) -> Any:
    environment = jinja2.Environment(undefined=jinja2.StrictUndefined)
    return environment.compile_expression(text, undefined_to_none=False)


def holds(condition: str, **content: Any) -> bool:
    """Tell whether a condition holds, an expression as forms have it. content: name in it -> value."""
    return bool(_expression(condition)(**content))
