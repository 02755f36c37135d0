"""``python -m railhil.panel.tcp_to_unix SOCKET PORT``: from a published port of a container to a panel without network.

The containers of a bench share a network namespace that cannot be reached from outside. The panel therefore listens at
a Unix socket in their common volume (``railhil panel --socket``), and this program, alone in a container with a
network, passes bytes between it and the port that Docker publishes on the host's loopback. It does not interpret the
bytes.
"""

from __future__ import annotations

import asyncio
import contextlib
import sys
from collections.abc import Sequence

from railhil.common.command_line import OneLineParser, whole_number
from railhil.common.exit_codes import run_guarded

_CHUNK_BYTES = 1 << 16


async def _pass(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Pass all bytes on until the end, or until one side has gone."""
    with contextlib.suppress(OSError):
        while data := await reader.read(_CHUNK_BYTES):
            writer.write(data)
            await writer.drain()
    writer.close()


async def open_gateway(socket: str, host: str, port: int) -> asyncio.Server:
    """Listen at ``host`` and ``port``, and connect each visitor to the socket.

    :raises OSError: the port cannot be opened.
    """

    async def connect(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            inside, outside = await asyncio.open_unix_connection(socket)
        except OSError:
            # The panel has not begun, or has ended: the page tries again.
            writer.close()
            return
        await asyncio.gather(_pass(reader, outside), _pass(inside, writer))

    return await asyncio.start_server(connect, host, port)


def main(words: Sequence[str] | None = None) -> int:
    """Pass bytes until a signal."""
    parser = OneLineParser(
        prog="python -m railhil.panel.tcp_to_unix", description="A port of a container for a panel's socket."
    )
    parser.add_argument("socket", help="of railhil panel --socket")
    parser.add_argument("port", type=whole_number(1, 65535), help="of all addresses of the container")
    namespace = parser.parse_args(words)

    async def serve() -> None:
        server = await open_gateway(namespace.socket, "0.0.0.0", namespace.port)
        await server.serve_forever()

    asyncio.run(serve())
    return 0


if __name__ == "__main__":
    sys.exit(run_guarded("python -m railhil.panel.tcp_to_unix", main))
