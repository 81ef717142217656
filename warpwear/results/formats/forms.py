"""Fill the forms of `templates/`: pages, paragraphs, LaTeX, XML of other software."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from warpwear import lazy

jinja2 = lazy.module("jinja2")


def filled(
    form: str, filters: Mapping[str, Any] = MappingProxyType({}), *, escape: bool = True, **content: Any
) -> str:
    """Fill a form; what is put in is escaped, unless the form is plain text. A missing name is an error.

    form: name of its file. filters: name in the form -> function. content: name in the form -> value.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("warpwear", "templates"),
        autoescape=escape,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(filters)
    return environment.get_template(form).render(content)
