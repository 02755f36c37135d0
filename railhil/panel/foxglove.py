"""A bridge for Lichtblick, PlotJuggler and Foxglove: the Foxglove WebSocket protocol with CDR payloads.

Messages are flat ROS 2 messages (:mod:`railhil.bus.ros2`), because PlotJuggler reads no others. Orders need a token,
reading does not. Programs and viewers served by this machine may connect, and the hosted viewers of :data:`_VIEWERS`;
other pages may not.

Source: foxglove/ws-protocol, docs/spec.md (opcodes, ``foxglove.websocket.v1``); ``foxglove.sdk.v1`` is the same for the
messages used here.
"""

from __future__ import annotations

import json
import re
import struct
from http import HTTPStatus
from typing import Any

import numpy as np
from websockets.asyncio.server import Server, ServerConnection, broadcast, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.typing import Subprotocol

from railhil.bus.ros2 import MESSAGE_ENCODING, SCHEMA_ENCODING, SIGNALS_TOPIC, Field, Message, PortMessage, ros_name
from railhil.panel.live import LiveRun
from railhil.panel.wire import POLICY_VIOLATION, TooDeep, is_token, parse_object
from railhil.record.trace import FloatArray, Trace

#: Names of the protocol, newest first, as offered by clients.
SUBPROTOCOLS = [Subprotocol("foxglove.sdk.v1"), Subprotocol("foxglove.websocket.v1")]
_CDR_HEADER = b"\0\1\0\0"
_MESSAGE_DATA, _TIME, _SERVICE_RESPONSE, _SERVICE_REQUEST = 1, 2, 3, 2
_WARNING = 1
_BACKLOG_MAX_BYTES = 1 << 20
#: Origins of viewers hosted elsewhere, and names of this machine.
_VIEWERS = ("https://app.foxglove.dev",)
_LOOPBACK = re.compile(r"(127\.0\.0\.1|localhost|\[::1\])(:\d+)?")
#: Rows of the default topics in one look: at 5 looks a second 60 Hz, above which viewers warn.
ROWS_A_LOOK = 12
#: Telegrams of a port on its /full topic in one look; more come only in lockstep.
_FULL_A_LOOK = 1000
_SIGNALS_ID, _FULL_ID = 1, 100
_ORDER = "/railhil/order"
_ORDER_SERVICE = 1
_REQUEST, _RESPONSE = "string token\nstring command", "bool done\nstring why"


class Viewer:
    """One client with its subscriptions, as (channel, the client's number of the subscription)."""

    def __init__(self, connection: ServerConnection) -> None:
        self.connection = connection
        self.channels: dict[int, int] = {}
        self.left_out = 0


class FoxgloveBridge:
    """Serves a live run to viewers, beside the pages.

    :param token: word that an order must carry; empty: there are no orders.
    """

    def __init__(self, live: LiveRun, token: str, port: int) -> None:
        self._live = live
        self._token = token
        self.port = port
        self._viewers: dict[ServerConnection, Viewer] = {}
        self._prepare()

    def _prepare(self) -> None:
        """Make the channels of the displayed live run."""
        live = self._live
        self._layout = live.layout
        self._run = live.listener.run
        # Viewers get the units in the columns' names.
        self._factors = np.array([column.factor for column in live.layout.columns])
        self._accepted: dict[str, int] = {}
        self._ports = {_FULL_ID + at: port for at, port in enumerate(live.contract.ports)}
        self._messages = {number: PortMessage(port) for number, port in self._ports.items()}
        self._columns = Message("Signals", [Field(ros_name(column.name), "float64") for column in live.layout.columns])

    async def listen(self) -> Server:
        """Open the port on 127.0.0.1.

        :raises OSError: it cannot be opened.
        """
        server = await serve(
            self._serve,
            "127.0.0.1",
            self.port,
            process_request=_refuse,
            subprotocols=SUBPROTOCOLS,
            compression=None,
            max_size=1 << 16,
        )
        self.port = server.sockets[0].getsockname()[1]
        return server

    # -- what is new ---------------------------------------------------------------------------------------------

    def tell(self) -> None:
        """Send the news of the last reading of the run."""
        live = self._live
        if not self._viewers:
            return
        if live.layout is not self._layout:
            self._readvertise()
        if live.listener.run != self._run:
            self._run = live.listener.run
            self._accepted.clear()
            for viewer in self._viewers.values():
                self._send(viewer, json.dumps(self._describe_server()))
        if not len(live.fresh_rows):
            return
        time_ns = live.listener.clock.now_ns
        for viewer in self._viewers.values():
            self._send(viewer, struct.pack("<BQ", _TIME, time_ns))
        self._send_signals(live.fresh_rows)
        self._send_telegrams(live.fresh_trace)

    def _send_signals(self, rows: FloatArray) -> None:
        step = -(-len(rows) // ROWS_A_LOOK)
        for row in rows[::-step][::-1]:
            self._publish(
                _SIGNALS_ID, round(float(row[0]) * 1e9), self._columns.packed((row[1:] / self._factors).tolist())
            )

    def _send_telegrams(self, trace: Trace) -> None:
        wanted = {channel for viewer in self._viewers.values() for channel in viewer.channels if channel >= _FULL_ID}
        for number in sorted(wanted):
            port = self._ports[number]
            accepted = self._live.listener.newest.store.accepted(port.name)
            new = min(accepted - self._accepted.get(port.name, accepted - 1), trace.count(port.name), _FULL_A_LOOK)
            self._accepted[port.name] = accepted
            if new <= 0:
                continue
            columns = [trace.numbers(port.name, item.name)[-new:].tolist() for item in port.signals]
            for time_ns, *row in zip(trace.times_ns(port.name)[-new:], *columns, strict=True):
                self._publish(number, time_ns, self._messages[number].packed(row))

    def _publish(self, channel: int, time_ns: int, payload: bytes) -> None:
        for viewer in self._viewers.values():
            if channel in viewer.channels:
                head = struct.pack("<BIQ", _MESSAGE_DATA, viewer.channels[channel], time_ns)
                self._send(viewer, head + payload)

    def _send(self, viewer: Viewer, message: str | bytes) -> None:
        if viewer.connection.transport.get_write_buffer_size() > _BACKLOG_MAX_BYTES:
            if not viewer.left_out:
                text = {"op": "status", "level": _WARNING, "message": "Send buffer limit reached"}
                broadcast([viewer.connection], json.dumps(text))
            viewer.left_out += 1
            return
        viewer.left_out = 0
        broadcast([viewer.connection], message)

    def _readvertise(self) -> None:
        """Another run is shown from now on: tell the viewers which channels have gone and which are new."""
        before = self._list_channels()
        self._prepare()
        now = self._list_channels()
        gone = [one["id"] for one in before if one not in now]
        texts = [
            json.dumps({"op": "unadvertise", "channelIds": gone}),
            json.dumps(self._describe_server()),
            json.dumps({"op": "advertise", "channels": [one for one in now if one not in before]}),
        ]
        for viewer in self._viewers.values():
            viewer.channels = {one: number for one, number in viewer.channels.items() if one not in gone}
            for text in texts:
                self._send(viewer, text)

    # -- one viewer ----------------------------------------------------------------------------------------------

    async def _serve(self, connection: ServerConnection) -> None:
        if connection.subprotocol not in SUBPROTOCOLS:
            await connection.close(1002, f"subprotocols: {', '.join(SUBPROTOCOLS)}")
            return
        viewer = Viewer(connection)
        await connection.send(json.dumps(self._describe_server()))
        await connection.send(json.dumps({"op": "advertise", "channels": self._list_channels()}))
        if self._token:
            await connection.send(json.dumps({"op": "advertiseServices", "services": [_describe_service()]}))
        self._viewers[connection] = viewer
        try:
            async for message in connection:
                try:
                    answer = (
                        self._call_service(message) if isinstance(message, bytes) else self._answer(viewer, message)
                    )
                except TooDeep as error:
                    await connection.close(POLICY_VIOLATION, str(error))
                    return
                if answer is not None:
                    await connection.send(answer)
        except ConnectionClosed:
            return
        finally:
            del self._viewers[connection]

    def _describe_server(self) -> dict[str, Any]:
        return {
            "op": "serverInfo",
            "name": "railhil",
            "capabilities": ["time", *(["services"] if self._token else [])],
            "supportedEncodings": [MESSAGE_ENCODING],
            "metadata": {"scenario": self._live.scenario_name},
            "sessionId": f"{self._live.session}-{self._run}",
        }

    def _list_channels(self) -> list[dict[str, Any]]:
        full = [
            _describe_channel(number, f"/full/{port.name}", self._messages[number])
            for number, port in self._ports.items()
        ]
        return [_describe_channel(_SIGNALS_ID, SIGNALS_TOPIC, self._columns), *full]

    def _answer(self, viewer: Viewer, text: str) -> str | None:
        try:
            asked = parse_object(text)
            if asked["op"] == "subscribe":
                known = {_SIGNALS_ID, *self._ports}
                wanted = {_read_number(one["channelId"]): _read_number(one["id"]) for one in asked["subscriptions"]}
                viewer.channels |= {channel: number for channel, number in wanted.items() if channel in known}
            elif asked["op"] == "unsubscribe":
                gone = set(asked["subscriptionIds"])
                viewer.channels = {channel: number for channel, number in viewer.channels.items() if number not in gone}
        except TooDeep:
            raise
        except (ValueError, TypeError, KeyError):
            return json.dumps({"op": "status", "level": _WARNING, "message": "not understood"})
        return None

    def _call_service(self, data: bytes) -> str | bytes:
        """An order of a viewer: token, and a command of the page as JSON (``{"do": "inject", "fault": 1}``)."""
        try:
            opcode, service, call, length = struct.unpack_from("<BIII", data)
            encoding, payload = data[13 : 13 + length], data[13 + length :]
            if (opcode, service, encoding) != (_SERVICE_REQUEST, _ORDER_SERVICE, b"cdr") or not self._token:
                raise ValueError("no such service")
            token, text = _read_strings(payload)
            command = parse_object(text)
        except TooDeep:
            raise
        except (struct.error, ValueError) as error:
            return json.dumps({"op": "status", "level": _WARNING, "message": f"service call: {error}"})
        why = self._live.execute(command) if is_token(token, self._token) else "wrong token"
        body = why.encode() + b"\0"
        response = _CDR_HEADER + struct.pack("<?3xI", not why, len(body)) + body
        return struct.pack("<BIII", _SERVICE_RESPONSE, service, call, 3) + b"cdr" + response


def _read_number(found: Any) -> int:
    """A number that a viewer has chosen, which goes back to it in 32 bit. Raises ValueError."""
    if not isinstance(found, int) or not 0 <= found < 1 << 32:
        raise ValueError("no number of 32 bit")
    return found


def _refuse(connection: ServerConnection, request: Request) -> Response | None:
    """Any page of the web could connect to a port of this machine: foreign pages are refused."""
    for origin in request.headers.get_all("Origin"):
        scheme, _, rest = origin.partition("://")
        is_web = scheme in ("http", "https", "null")
        if is_web and origin not in _VIEWERS and not _LOOPBACK.fullmatch(rest):
            allowed = f"a viewer of this machine, or {', '.join(_VIEWERS)}"
            return connection.respond(HTTPStatus.FORBIDDEN, f"origin: found {origin!r}, allowed {allowed}\n")
    return None


def _describe_channel(number: int, topic: str, message: Message) -> dict[str, Any]:
    return {
        "id": number,
        "topic": topic,
        "encoding": MESSAGE_ENCODING,
        "schemaName": message.name,
        "schema": message.schema,
        "schemaEncoding": SCHEMA_ENCODING,
    }


def _describe_service() -> dict[str, Any]:
    def half(name: str, schema: str) -> dict[str, str]:
        return {"encoding": "cdr", "schemaName": name, "schemaEncoding": "ros2msg", "schema": schema}

    return {
        "id": _ORDER_SERVICE,
        "name": _ORDER,
        "type": "railhil/srv/Order",
        "request": half("railhil/srv/Order_Request", _REQUEST),
        "response": half("railhil/srv/Order_Response", _RESPONSE),
        "requestSchema": _REQUEST,
        "responseSchema": _RESPONSE,
    }


def _read_strings(payload: bytes) -> tuple[str, str]:
    """The two strings of a request.

    :raises ValueError, struct.error: it is none.
    """
    at, found = len(_CDR_HEADER), []
    if payload[:2] != _CDR_HEADER[:2]:
        raise ValueError("not CDR, little-endian")
    for _ in range(2):
        at += -(at - len(_CDR_HEADER)) % 4
        (length,) = struct.unpack_from("<I", payload, at)
        found.append(payload[at + 4 : at + 4 + length].rstrip(b"\0").decode())
        at += 4 + length
    return found[0], found[1]
