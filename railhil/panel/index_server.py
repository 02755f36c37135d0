"""Serves the index of a directory; from it, recorded runs with their pages, one or two at a time, and their reports."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from hashlib import sha256
from http import HTTPStatus
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from railhil.common.errors import InputError
from railhil.index.curves import all_curves
from railhil.index.find import RUN, find_folders
from railhil.index.page import page
from railhil.index.tables import open_index
from railhil.panel.recorded import RecordedRuns
from railhil.panel.server import RATE_HZ, REPORT_POLICY, PanelServer
from railhil.record.hash_list import REPORT

#: Paths of the page of some runs, and of requests for one, for a report and for the signals of a run: run=FOLDER, once
#: or several times.
_PANEL, _OPEN, _REPORT, _SIGNALS = "/panel/", "/panel/open", "/report", "/signals"
#: Pages that are kept; of more the one that was opened first is forgotten.
_PAGES_MAX = 12
#: The page's own program stands in it, as in a report; it may remember when its reader looked, and ask for signals.
_INDEX_POLICY = REPORT_POLICY.replace("sandbox allow-scripts", "connect-src 'self'")


class IndexServer(PanelServer):
    """The index of a directory at ``/``, and a :class:`PanelServer` for each choice of its runs.

    :param requirements: as of :class:`RecordedRuns`.
    """

    def __init__(self, root: Path, requirements: Sequence[str], token: str, port: int) -> None:
        # It has no source of its own: what reads one is done by the servers of its pages.
        super().__init__(None, token, port)  # type: ignore[arg-type]
        self._root, self._requirements = root, requirements
        self._opened: dict[str, PanelServer] = {}

    def close(self) -> None:
        for panel in self._opened.values():
            panel.close()

    async def run(self, ends: Callable[[], bool], beside: Callable[[], None] = lambda: None) -> None:
        """Until ``ends``; the pages of runs are read by tasks of their own."""
        while not ends():
            for panel in self._opened.values():
                panel.tell_news()
            beside()
            await asyncio.sleep(1.0 / RATE_HZ)

    def _serve_file(self, connection: ServerConnection, request: Request) -> Response | None:
        if request.headers.get("Host") not in self._hosts:
            return connection.respond(HTTPStatus.NOT_FOUND, "not found\n")
        parts = urlsplit(request.path)
        if parts.path in (_OPEN, _REPORT, _SIGNALS):
            folders = parse_qs(parts.query).get("run", [])
            known = {one.folder: one for one in find_folders(self._root)[0]}
            if not folders or any(one not in known for one in folders):
                return connection.respond(HTTPStatus.NOT_FOUND, "not found\n")
            if parts.path == _OPEN and all(known[one].kind == RUN for one in folders):
                return self._open(connection, folders)
            if parts.path == _SIGNALS:
                text = json.dumps(all_curves(self._root / folders[0]))
                return self._page(text.encode(), "application/json", REPORT_POLICY)
            try:
                content = (self._root / folders[0] / REPORT).read_bytes()
            except OSError:
                return connection.respond(HTTPStatus.NOT_FOUND, "not found\n")
            return self._page(content, "text/html", REPORT_POLICY)
        if parts.path.startswith(_PANEL):
            key, _, rest = parts.path.removeprefix(_PANEL).partition("/")
            if key not in self._opened:
                return connection.respond(HTTPStatus.NOT_FOUND, "open these runs from the index again\n")
            return self._opened[key]._serve_file(connection, replace(request, path=f"/{rest}"))
        if parts.path == "/":
            return self._page(page(open_index(self._root), "", is_served=True).encode(), "text/html", _INDEX_POLICY)
        found = HTTPStatus.NO_CONTENT if parts.path == "/favicon.ico" else HTTPStatus.NOT_FOUND
        return connection.respond(found, "" if found is HTTPStatus.NO_CONTENT else "not found\n")

    def _open(self, connection: ServerConnection, folders: Sequence[str]) -> Response:
        """The page of these runs, at an address of its own."""
        key = sha256("\n".join(folders).encode()).hexdigest()[:16]
        try:
            # A run that was made again is read again.
            runs = RecordedRuns([str(self._root / one) for one in folders], self._requirements)
        except InputError as error:
            return connection.respond(HTTPStatus.CONFLICT, f"{error}\n")
        if key in self._opened:
            self._opened.pop(key).close()
        self._opened[key] = PanelServer(runs, self.token, self.port)
        while len(self._opened) > _PAGES_MAX:
            self._opened.pop(next(iter(self._opened))).close()
        found = HTTPStatus.SEE_OTHER
        headers = Headers({"Location": f"{_PANEL}{key}/", "Content-Length": "0", "Connection": "close"})
        return Response(found.value, found.phrase, headers, b"")

    async def _serve(self, connection: ServerConnection) -> None:
        assert connection.request is not None
        key = connection.request.path.removeprefix(_PANEL).partition("/")[0]
        if key in self._opened:
            await self._opened[key]._serve(connection)
