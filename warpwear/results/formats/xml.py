"""Fill the XML of other software's files into their forms, which stand in templates/."""

from importlib.resources import files
from typing import Any

from warpwear import lazy

jinja2 = lazy.module("jinja2")


def filled(form: str, **content: Any) -> bytes:
    """Fill a form; what is put in is escaped. form: name of its file; content: by the names in it."""
    text = files("warpwear").joinpath("templates", form).read_text(encoding="utf-8")
    template = jinja2.Template(text, autoescape=True, trim_blocks=True, lstrip_blocks=True)
    xml: str = template.render(content)
    return xml.encode()
