"""The site of the documentation: its links, what it loads, and whether everybody can read it."""

from __future__ import annotations

from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest

from hil_tests.documents.made_pages import made_pages
from hil_tests.documents.site import DOCS, build
from hil_tests.support.browser import chromium_or_skip
from railhil.cli.commands import GROUPS

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]
#: One page of each kind that differs in how it looks.
LOOKED_AT = (
    "index.html",
    "howto/testing.html",
    "explanation/bench.html",
    "reference/commands/run.html",
    "reference/faults.html",
)
WIDTHS_PX = (400, 1200)


class _Targets(HTMLParser):
    """Names of the places of a page, and where its links and other parts lie."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.places: set[str] = {"", "top"}
        self.links: list[str] = []
        self.parts: list[str] = []
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value for name, value in attrs if value is not None}
        self.places |= {given[name] for name in ("id", "name") if name in given}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        else:
            self.parts += [given[name] for name in ("src", "href") if name in given]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    assert build(folder / "site", folder / "pages", DOCS, made_pages()) == 0
    return folder / "site"


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with chromium_or_skip() as found:
        yield found


@pytest.mark.long
def test_every_link_and_part_of_the_site_is_there(site: Path) -> None:
    pages = {page: _Targets(page) for page in site.rglob("*.html")}
    assert len(pages) > 40
    lost, seen = [], 0
    for page, targets in pages.items():
        for address in (*targets.links, *targets.parts):
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                assert address in targets.links or parts.scheme == "data", (page, address)
                # An address such as tcp://HOST:PORT is an example.
                assert parts.scheme in ("https", "data", "javascript"), (page, address)
                continue
            path = (page.parent / unquote(parts.path)).resolve() if parts.path else page
            place = unquote(parts.fragment)
            seen += 1
            if not path.exists() or (path.suffix == ".html" and place not in pages[path].places):
                lost.append((page.relative_to(site), address))
    assert (lost, seen > 1000) == ([], True)


@pytest.mark.long_after(1)
@pytest.mark.parametrize("link", ["howto/none.md", "howto/task.md#nowhere", "#nowhere", "../none.md"])
def test_a_link_that_leads_nowhere_is_an_error(tmp_path: Path, link: str, capfd: pytest.CaptureFixture[str]) -> None:
    docs = tmp_path / "docs"
    (docs / "howto").mkdir(parents=True)
    (docs / "howto" / "task.md").write_text("# A task\n", encoding="utf-8")
    (docs / "index.md").write_text(f"# The entrance\n\n[there]({link}) and [a task](howto/task.md#a-task)\n", "utf-8")
    assert build(tmp_path / "site", tmp_path / "pages", docs, {}) == 1
    said = capfd.readouterr().err
    assert "index.md:3" in said
    assert link.rpartition("#")[2] in said


@pytest.mark.long
def test_commands_keys_and_the_library_are_pages_of_the_site(site: Path) -> None:
    """With an anchor for each option, and for each name of the library."""
    places = _Targets(site / "reference" / "commands" / "run.html").places
    assert {"cmdoption-railhil-run-seed", "cmdoption-railhil-run-controller"} <= places
    commands = [name for group in GROUPS.values() for name in group]
    assert [name for name in commands if not (site / "reference" / "commands" / f"{name}.html").exists()] == []
    assert "task.start_spread_kmh" in (site / "reference" / "scenario_keys_stop.html").read_text(encoding="utf-8")
    entrance = _Targets(site / "index.html").links
    assert {"reference/commands.html", "reference/api.html"} <= set(entrance)
    keys = [entrance.index(f"reference/scenario_keys{name}.html") for name in ("", "_emu3", "_hst1", "_line", "_stop")]
    assert keys == list(range(keys[0], keys[0] + len(keys)))
    places = _Targets(site / "reference" / "api.html").places
    assert {"railhil.library.run", "railhil.library.campaign", "railhil.testing.bench.Bench"} <= places


@pytest.mark.long
@pytest.mark.needs_browser
def test_the_site_asks_nobody_and_finds_words(site: Path, chromium: Any) -> None:
    asked: list[str] = []
    page = chromium.new_page()
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: asked.append(str(error)))
    for name in LOOKED_AT:
        page.goto((site / name).as_uri())
    page.get_by_role("textbox").first.fill("notch")
    page.keyboard.press("Enter")
    page.locator(".search a").first.wait_for()
    assert len(asked) > len(LOOKED_AT)
    assert [address for address in asked if not address.startswith(("data:", site.as_uri()))] == []


@pytest.mark.long
@pytest.mark.needs_browser
@pytest.mark.parametrize("name", LOOKED_AT)
def test_everybody_can_read_the_site(site: Path, chromium: Any, name: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="MISSING CAPABILITY axe").Axe()
    for scheme in ("light", "dark"):
        for width_px in WIDTHS_PX:
            page = chromium.new_page(color_scheme=scheme, viewport={"width": width_px, "height": 900})
            page.goto((site / name).as_uri())
            assert page.evaluate("document.documentElement.scrollWidth") <= width_px
            found = axe.run(page)
            assert found.violations_count == 0, (scheme, width_px, found.generate_report())
            page.close()
