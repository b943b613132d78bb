"""Is a built site whole? Links and their anchors, pictures, nothing from the network, version.

`python docs/builder/links.py build/site` prints what is wrong, and ends with 1 if anything is.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {"img": "src", "script": "src", "link": "href", "source": "src"}
OF_THE_THEME = "_static"
WORDS = {"canonical", "search", "next", "prev", "index"}  # links of the head that load nothing


class Page(HTMLParser):
    """Anchors of a page, what it links to, what it loads, and its words about the edition."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = {"", "top"}
        self.links: list[str] = []
        self.loads: list[str] = []
        self.editions: list[str] = []
        self._in_edition = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Anchors and addresses of an element."""
        values = {name: value or "" for name, value in attrs}
        self.anchors |= {values[name] for name in ("id", "name") if name in values}
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        address = values.get(LOADED.get(tag, ""))
        if address and values.get("rel") not in WORDS:
            self.loads.append(address)
        self._in_edition = values.get("class") == "edition"

    def handle_data(self, data: str) -> None:
        """Text: that of the edition is kept."""
        if self._in_edition and data.strip():
            self.editions.append(data.strip())
            self._in_edition = False


def faults(site: Path, version: str) -> list[str]:
    """A sentence for each fault of the pages below a folder."""
    site = site.resolve()
    files = [path for path in sorted(site.rglob("*.html")) if OF_THE_THEME not in path.parts]
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in files}
    messages = [] if pages else [f"{site}: no pages"]
    for path, page in pages.items():
        name = path.relative_to(site)
        if not any(version in words and "built" in words for words in page.editions):
            messages.append(f"{name}: neither version {version} nor date")
        for address in page.loads:
            if urlsplit(address).netloc:
                messages.append(f"{name}: loads {address} from the network")
        for address in {*page.links, *page.loads}:
            if not _leads_somewhere(address, path, pages):
                messages.append(f"{name}: {address} leads nowhere")
    return messages


def _leads_somewhere(address: str, page: Path, pages: dict[Path, Page]) -> bool:
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        return True
    target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    target = target / "index.html" if target.is_dir() else target
    if target not in pages:
        return target.exists()
    return unquote(parts.fragment) in pages[target].anchors


if __name__ == "__main__":
    import thermobearing

    wrong = faults(Path(sys.argv[1]), thermobearing.__version__)
    print(*wrong, sep="\n", end="\n" if wrong else "")
    sys.exit(bool(wrong))
