"""``python -m hil_tests.documents.site [FOLDER]`` (``make docs``): the site of all pages, in build/site.

Its sources are copies of the pages of docs, and those of :mod:`hil_tests.documents.made_pages`, in
``build/site_pages``. Each kind of page has an index, in which the pages
to which docs/index.md links come first, in its order; a page that goes on with another one's name follows it. The
entrance of the site links the pages made from the code, too. Each broken link is an error.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from hil_tests.documents.made_pages import made_pages
from hil_tests.documents.pages import FOLDERS
from hil_tests.support.paths import ROOT
from hil_tests.support.venvs import project

DOCS = ROOT / "docs"
SITE = ROOT / "build" / "site"
PAGES = ROOT / "build" / "site_pages"
#: Folder -> title of its index, and what its pages are.
KINDS: Mapping[str, tuple[str, str]] = {
    "tutorial": ("Tutorial", "Learn railhil by using it."),
    "howto": ("How-to guides", "Steps of one task each."),
    "explanation": ("Explanation", "How the bench works, and why."),
    "reference": ("Reference", "Keys, commands, formats and figures, to look up."),
}
#: Below reference: pages that commands write whole.
_WRITTEN = "reproduce/*/page.md"
_LINK = re.compile(r"\]\(([^)#\s]+)\.(?:md|rst)\b")
#: A link out of the folder docs.
_OUTSIDE = re.compile(r"\]\(((?:\.\./)+[^)#\s]+)")


def lay_out(docs: Path, pages: Path, made: Mapping[str, str]) -> None:
    """Write the sources of the site into an empty folder.

    :param docs: the folder of the pages.
    :param made: further pages, by their path below docs.
    """
    shutil.copytree(docs, pages, ignore=shutil.ignore_patterns("conf.py", "_static", "__pycache__"))
    for page in pages.rglob("*.md"):
        page.write_text(_with_addresses(page.read_text("utf-8"), docs / page.relative_to(pages)), "utf-8")
    for name, text in made.items():
        (pages / name).parent.mkdir(parents=True, exist_ok=True)
        (pages / name).write_text(text, "utf-8")
    entrance = pages / "index.md"
    text = entrance.read_text("utf-8") + _links_to(made)
    first = {name: place for place, name in reversed(list(enumerate(_LINK.findall(text))))}

    def place_of(name: str) -> tuple[int, str]:
        stem = name.rpartition(".")[0]
        place = first.get(stem, first.get(stem.rpartition("_")[0], sys.maxsize))
        return place, _title(pages / name)

    for kind in FOLDERS:
        found = [
            *(pages / kind).glob("*.md"),
            *(pages / kind).glob("*.rst"),
            *(pages.glob(_WRITTEN) if kind == "reference" else ()),
        ]
        order = sorted((page.relative_to(pages).as_posix() for page in found), key=place_of)
        (pages / kind).mkdir(exist_ok=True)
        title, what = KINDS[kind]
        (pages / kind / "index.md").write_text(f"# {title}\n\n{what}\n\n{_toctree(order)}", "utf-8")
    entrance.write_text(f"{text}\n{_toctree([f'{kind}/index.md' for kind in FOLDERS], ':hidden:')}", "utf-8")


def _links_to(made: Mapping[str, str]) -> str:
    """The part of the entrance on pages that are not in the repository: lists and tables made from the code."""
    names = [name for name in made if name.endswith(".rst") and name.count("/") == 1]
    links = ", ".join(f"[{_title_of(made[name])}]({name})" for name in names)
    return f"\nMade from the code: {links}.\n" if links else ""


def _with_addresses(text: str, page: Path) -> str:
    """A page whose links to files outside docs are addresses in the repository."""

    def address(found: re.Match[str]) -> str:
        target = Path(os.path.normpath(page.parent / found[1]))
        is_outside = target.is_relative_to(ROOT) and not target.is_relative_to(DOCS)
        if not is_outside or not target.exists():
            return found[0]
        return f"]({project()['urls']['Homepage']}/blob/main/{target.relative_to(ROOT).as_posix()}"

    return _OUTSIDE.sub(address, text)


def _title(page: Path) -> str:
    return _title_of(page.read_text("utf-8")).lower()


def _title_of(text: str) -> str:
    return text.partition("\n")[0].removeprefix("# ")


def _toctree(names: Sequence[str], option: str = ":maxdepth: 1") -> str:
    lines = "\n".join(f"/{name.rpartition('.')[0]}" for name in names)
    return f"```{{toctree}}\n{option}\n\n{lines}\n```\n"


def build(site: Path, pages: Path, docs: Path, made: Mapping[str, str]) -> int:
    """Make the site anew; returns 0, or what Sphinx returns if a page has a fault.

    :param site: its folder.
    :param pages: the folder of its sources; parsed pages are kept beside it.
    :param docs: the folder of the pages, to which those of ``made`` are added, by their path below docs.
    """
    for folder in (site, pages):
        shutil.rmtree(folder, ignore_errors=True)
    lay_out(docs, pages, made)
    parsed = pages.with_name(f"{pages.name}_parsed")
    words = ["-q", "-W", "--keep-going", "-E", "-j", "auto", "-c", DOCS, "-d", parsed, pages, site]
    return subprocess.run([sys.executable, "-m", "sphinx", *words], check=False).returncode


def main() -> int:
    """Command line; see the module's docstring."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.documents.site")
    parser.add_argument("folder", nargs="?", type=Path, default=SITE, metavar="FOLDER", help="of the site (build/site)")
    folder = parser.parse_args().folder
    code = build(folder, PAGES, DOCS, made_pages())
    print(folder / "index.html" if code == 0 else "the site has faults; see above", flush=True)
    return code


if __name__ == "__main__":
    sys.exit(main())
