"""What tests of pages share: hostile names, how a browser opens a page, what a page may hold."""

from html.parser import HTMLParser
from pathlib import Path
from typing import Any

#: Bytes of a page.
MOST = 6e6
EVIL = "<script>alert(1)</script> \"'$x$ </scr" + "x" * 300 + " {{ 7 * 7 }} &amp;"
#: The like as far as the name of a file or a folder goes.
EVIL_FILE = "<script>alert(1)<img src=x onerror=alert(1)>\"'$x$ {{ 7 * 7 }}" + "x" * 150


def visit(browser: Any, path: Path, **how: Any) -> tuple[Any, list[str], list[str]]:
    """Open a page; returns it, what it requested beside itself, and its errors."""
    page, requests, errors = browser.new_page(**how), [], []
    page.on("request", lambda request: requests.append(request.url))
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("dialog", lambda dialog: errors.append(dialog.message))
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-ready]", timeout=90_000)
    return page, [url for url in requests if url != path.as_uri()], errors


class Parts(HTMLParser):
    """The tags of a page, and where its links lead."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.sources: list[str] = []
        self.links: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        assert not [name for name, _ in attrs if name.startswith("on")], attrs
        self.sources += [value or "" for name, value in attrs if name == "src"]
        self.links += [value or "" for name, value in attrs if name == "href"]


def check_page(path: Path) -> tuple[str, Parts]:
    """Check that a page needs nothing, is light, and runs its own three scripts alone; return both."""
    page = path.read_text(encoding="utf-8")
    assert len(page.encode()) <= MOST
    parts = Parts(page)
    assert parts.tags.count("script") == 3
    assert all(source.startswith("data:image/png;base64,") for source in parts.sources)
    assert not [link for link in parts.links if ":" in link.split("/")[0]]
    assert "url(" not in page
    assert "<script>alert" not in page
    assert "onerror=alert(1)>" not in page
    return page, parts
