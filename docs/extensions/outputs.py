"""What cells printed and drew stands in the Markdown too, for those who read it where no site is made.

The site shows what came out when it was made, so there these copies are left out.
"""

import hashlib
import re
from typing import Any

BEGIN, END = "<!-- what came out: {} -->", "<!-- end of what came out -->"
COPY = re.compile(r"\n<!-- what came out: (\w+) -->\n.*?<!-- end of what came out -->\n", re.DOTALL)
CELL = re.compile(r"^```\{code-cell\} ipython3\n(.*?)^```\n", re.DOTALL | re.MULTILINE)


def without(text: str) -> str:
    """Return a page without its copies."""
    return COPY.sub("", text)


def cells(text: str) -> list[tuple[int, str, str]]:
    """Return of each cell of a page without copies its end, its text, and a digest of it and those above."""
    digest, found = hashlib.sha256(), []
    for match in CELL.finditer(text):
        digest.update(match[1].encode())
        found.append((match.end(), match[1], digest.hexdigest()[:8]))
    return found


def _left_out(app: Any, name: str, content: list[str]) -> None:
    content[0] = without(content[0])


def setup(app: Any) -> dict[str, bool]:
    """Take the copies out of each page that is read."""
    app.connect("source-read", _left_out)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
