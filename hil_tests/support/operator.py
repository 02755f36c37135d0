"""A hand at the socket of a run (``--operator``)."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any


def pressed(desk: Path, command: dict[str, Any]) -> bool:
    """Give a command; False while there is no socket. Before the run begins it waits for the second SUP_CMD."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as hand:
            hand.connect(str(desk))
            hand.send(json.dumps(command).encode())
    except (FileNotFoundError, ConnectionRefusedError):
        return False
    return True
