"""The page's server: static files and one WebSocket, on loopback, in one thread.

A page gets all news as long as it keeps up; otherwise everything so far once it has taken what it was sent.
"""

from __future__ import annotations

import asyncio
import errno
import json
from collections.abc import Callable, Sequence
from http import HTTPStatus
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from websockets.asyncio.server import Server, ServerConnection, broadcast, serve, unix_serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.typing import Subprotocol

from railhil.panel.wire import POLICY_VIOLATION, SUBPROTOCOL, TooDeep, is_token, parse_object
from railhil.scenarios.options import PANEL_PORT

if TYPE_CHECKING:
    from railhil.panel.branches import Branches

#: Largest number of batches a second; a reading costs about the same for few frames as for many.
RATE_HZ = 5.0
#: Bytes that may wait for a page; beyond it, and what it was sent of the past, news is left out.
_BACKLOG_MAX_BYTES = 1 << 20
_POLICY = "default-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
#: Of a report, which has its own script and asks for nothing.
REPORT_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; sandbox allow-scripts; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
_SCRIPTS = (
    "panel", "desk", "store", "curves", "gauges", "fault_form", "orders", "end", "line", "requirements", "branch"
)  # fmt: skip
_OWN = ("panel.css", *(f"{name}.js" for name in _SCRIPTS))
_OF_CHARTS = (
    "uPlot.iife.min.js", "uPlot.min.css", "gridstack-all.js", "gridstack.min.css", "view.js", "charts.js", "charts.css"
)  # fmt: skip
#: Path of the report of the run, and of that of a branch, before its number.
_REPORT, _BRANCH = "/report", "/branch/"
#: Path -> package and file.
_FILES = {
    "/": ("railhil.panel", "static/panel.html"),
    **{f"/{name}": ("railhil.panel", f"static/{name}") for name in _OWN},
    **{f"/{name}": ("railhil.charts", f"static/{name}") for name in _OF_CHARTS},
}


class PageSource(Protocol):
    """What is shown."""

    @property
    def branches(self) -> Branches | None:
        """Makes branches of a recorded run; None: there is none."""

    def describe(self) -> dict[str, Any]:
        """The first message to a page."""

    def read_past(self) -> list[str | bytes]:
        """Everything so far."""

    def look(self) -> list[str | bytes]:
        """The news; called :data:`RATE_HZ` times a second."""

    def list_frames(self) -> str:
        """The list of frames for the pages that show it; called after :meth:`look`, empty if there is none."""

    def execute(self, command: dict[str, Any]) -> str:
        """Carry out a command of a page with the right token; returns the reason if it was refused, else empty."""

    def watch(self, can_ids: set[int]) -> None:
        """Keep raw frames of these identifiers."""

    @property
    def report(self) -> Path | None:
        """The report of the run that has ended; None: there is none."""

    def list_kinds(self) -> list[dict[str, Any]]:
        """Kinds of faults that take values during the run (:func:`railhil.panel.operator.list_fault_kinds`)."""


class Page:
    """One page that is connected."""

    def __init__(self, connection: ServerConnection) -> None:
        self.connection = connection
        #: Whether news was left out because it did not keep up.
        self.lags = False
        #: Bytes that may wait for it.
        self.backlog_max_bytes = _BACKLOG_MAX_BYTES
        self.watched: int | None = None
        self.shows_frames = False
        #: Whether it has shown the right token.
        self.may_order = False


class PanelServer:
    """Serves one source to any number of pages.

    :param token: word that commands must carry; empty: there are no commands.
    :param socket: listen at this Unix socket instead of ``port``; another program publishes it under that port.
    """

    def __init__(self, source: PageSource, token: str, port: int, socket: str | None = None) -> None:
        self._source = source
        self._socket = socket
        self.token = token
        self._pages: dict[ServerConnection, Page] = {}
        #: Whether the source is read while there is no page.
        self.looks_alone = True
        self.port = port

    @property
    def address(self) -> str:
        """The page's address without the token."""
        return f"http://127.0.0.1:{self.port}/"

    async def listen(self) -> Server:
        """Open the port; 0 becomes a free one, and so does :data:`PANEL_PORT` if another program has it.

        :raises OSError: it cannot be opened.
        """
        how: dict[str, Any] = {
            "process_request": self._serve_file,
            "subprotocols": [Subprotocol(SUBPROTOCOL)],
            "compression": None,
            "max_size": 1 << 16,
            "server_header": "railhil",
        }
        if self._socket is not None:
            return await unix_serve(self._serve, self._socket, **how)
        try:
            server = await serve(self._serve, "127.0.0.1", self.port, **how)
        except OSError as error:
            if error.errno != errno.EADDRINUSE or self.port != PANEL_PORT:
                raise
            server = await serve(self._serve, "127.0.0.1", 0, **how)
        self.port = server.sockets[0].getsockname()[1]
        return server

    def count_desks(self) -> int:
        """Number of open pages that may give orders."""
        return sum(page.may_order for page in self._pages.values())

    def close(self) -> None:
        """End what was begun for the pages."""
        if self._source.branches is not None:
            self._source.branches.close()

    async def run(self, ends: Callable[[], bool], beside: Callable[[], None] = lambda: None) -> None:
        """Read the source and send its news to the pages, until ``ends``.

        :param beside: called after each reading.
        """
        while not ends():
            if self._pages or self.looks_alone:
                self.tell_news()
                beside()
            # On a busy machine, too, there is time between two readings: a page that comes is served then.
            await asyncio.sleep(1.0 / RATE_HZ)

    def tell_news(self) -> None:
        """Read the source once, and send its news to the pages."""
        pages = list(self._pages.values())
        for message in self._source.look():
            self._tell(message, pages)
        for page in pages:
            if page.lags and not page.connection.transport.get_write_buffer_size():
                page.lags = False
                self._tell_everything(page)
        showing = [page for page in pages if page.shows_frames]
        if showing and (text := self._source.list_frames()):
            self._tell(text, showing)

    def _tell_everything(self, page: Page) -> None:
        """Header and all data so far, at once: no news can come between them."""
        header = self._source.describe()
        header["commands"] = bool(self.token) and header.get("commands", False)
        for message in (json.dumps({"header": header}), *self._source.read_past()):
            broadcast([page.connection], message)
        # A long run may itself be more than may wait.
        page.backlog_max_bytes = _BACKLOG_MAX_BYTES + page.connection.transport.get_write_buffer_size()

    @staticmethod
    def _tell(message: str | bytes, pages: Sequence[Page]) -> None:
        """Send without waiting; the reading side notices a page that has gone."""
        takes = []
        for page in pages:
            if page.lags or page.connection.transport.get_write_buffer_size() > page.backlog_max_bytes:
                page.lags = True
                continue
            takes.append(page.connection)
        if takes:
            broadcast(takes, message)

    def _serve_file(self, connection: ServerConnection, request: Request) -> Response | None:
        path = request.path.partition("?")[0]
        if path == "/ws":
            return self._check_origin(connection, request)
        if path == _REPORT or path.startswith(_BRANCH):
            return self._serve_report(connection, request, path.removeprefix(_BRANCH))
        if path not in _FILES:
            found = HTTPStatus.NO_CONTENT if path == "/favicon.ico" else HTTPStatus.NOT_FOUND
            return connection.respond(found, "" if found is HTTPStatus.NO_CONTENT else "not found\n")
        package, name = _FILES[path]
        body = files(package).joinpath(name).read_bytes()
        return self._page(body, _TYPES[name[name.rindex(".") :]], _POLICY)

    def _serve_report(self, connection: ServerConnection, request: Request, number: str) -> Response:
        """A report; not to a page that reaches this server under a foreign name."""
        branches, own, body = self._source.branches, self._source.report, None
        if request.headers.get("Host") in self._hosts:
            if number == _REPORT:
                body = own.read_bytes() if own is not None and own.is_file() else None
            elif branches is not None:
                body = branches.report(number)
        if body is None:
            return connection.respond(HTTPStatus.NOT_FOUND, "not found\n")
        return self._page(body, "text/html", REPORT_POLICY)

    @staticmethod
    def _page(body: bytes, kind: str, policy: str) -> Response:
        headers = Headers(
            {
                "Content-Type": f"{kind}; charset=utf-8",
                "Content-Length": str(len(body)),
                "Content-Security-Policy": policy,
                "X-Content-Type-Options": "nosniff",
                "Referrer-Policy": "no-referrer",
                "Cache-Control": "no-store",
                "Connection": "close",
            }
        )
        return Response(HTTPStatus.OK.value, HTTPStatus.OK.phrase, headers, body)

    @property
    def _origins(self) -> set[str]:
        """The origins of the own pages."""
        return {f"http://{host}:{self.port}" for host in ("127.0.0.1", "localhost", "[::1]")}

    @property
    def _hosts(self) -> set[str]:
        """Names under which this server is reached; a foreign name that leads here gets no report."""
        return {origin.removeprefix("http://") for origin in self._origins}

    def _check_origin(self, connection: ServerConnection, request: Request) -> Response | None:
        """A foreign page must not talk to this server, under any name of this machine."""
        origins = request.headers.get_all("Origin")
        if len(origins) != 1 or origins[0] not in self._origins:
            return connection.respond(HTTPStatus.FORBIDDEN, "origin not allowed\n")
        return None

    async def _serve(self, connection: ServerConnection) -> None:
        if connection.subprotocol != SUBPROTOCOL:
            await connection.close(1002, f"subprotocol {SUBPROTOCOL} only")
            return
        page = Page(connection)
        self._tell_everything(page)
        self._pages[connection] = page
        try:
            async for text in connection:
                try:
                    answer = self._answer(page, parse_object(text))
                except TooDeep as error:
                    await connection.close(POLICY_VIOLATION, str(error))
                    return
                except ValueError as error:
                    answer = {"refused": str(error)}
                if answer is not None:
                    await connection.send(json.dumps(answer))
        except ConnectionClosed:
            return
        finally:
            del self._pages[connection]
            self._watch()

    def _answer(self, page: Page, asked: dict[str, Any]) -> dict[str, Any] | None:
        if "watch" in asked:
            page.watched = asked["watch"] if isinstance(asked["watch"], int) else None
            self._watch()
            return None
        if "frames" in asked:
            page.shows_frames = asked["frames"] is True
            return None
        if "kinds" in asked:
            return {"kinds": self._source.list_kinds()}
        token = asked.pop("token", None)
        if not self.token:
            return {"refused": "this page takes no commands"}
        if not is_token(token, self.token):
            return {"refused": "wrong token: open the address that the command has printed", "stale": True}
        page.may_order = True
        if asked.get("do") == "hello":
            return None
        why = self._source.execute(asked)
        return {"refused": why} if why else {"done": asked.get("do", "")}

    def _watch(self) -> None:
        self._source.watch({page.watched for page in self._pages.values() if page.watched is not None})
