"""Check that all links of the site have a target, without a network.

Every ``href`` and ``src`` that is no address of the web must be a file of the site, and its
fragment an ``id`` in that file. Nothing that a browser loads by itself may come from the web.

    python3 tools/site/links.py results/site
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {"script": "src", "img": "src", "iframe": "src", "link": "href"}
"""What a browser loads when it opens a page."""


class Reader(HTMLParser):
    """Links and names of one page."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[tuple[str, str]] = []
        self.names: set[str] = set()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Keep what a tag links to, and what it is called."""
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.names.add(value)
            elif name in ("href", "src") and value is not None:
                self.links.append((tag, value))


@cache
def read(page: Path) -> Reader:
    """Links and names of a page."""
    reader = Reader()
    reader.feed(page.read_text(encoding="utf-8"))
    return reader


def dead(page: Path) -> Iterator[str]:
    """Links of a page that lead nowhere."""
    for tag, link in read(page).links:
        parts = urlsplit(link)
        if parts.scheme in ("http", "https") or parts.netloc:
            if tag in LOADED:
                yield f"{link} is loaded from the web"
            continue
        if parts.scheme:  # mailto, data
            continue
        target = page if not parts.path else (page.parent / unquote(parts.path)).resolve()
        if not target.is_file():
            yield f"{link}: no such file"
        elif parts.fragment and target.suffix == ".html":
            if unquote(parts.fragment) not in read(target).names:
                yield f"{link}: no such name in it"


def main() -> None:
    """Print dead links; status 1 if there are any."""
    folder = Path(sys.argv[1]).resolve()
    pages = sorted(page for page in folder.rglob("*.html") if "pages" not in page.parts)
    found = [f"{page.relative_to(folder)}: {text}" for page in pages for text in dead(page)]
    print("\n".join([*found, f"{len(pages)} pages, {len(found)} dead links"]))
    sys.exit(bool(found) or not pages)


if __name__ == "__main__":
    main()
