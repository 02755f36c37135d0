"""Write ``railhil.dbc`` from the port table: ``python -m railhil.dbc.generate`` (or ``make dbc``)."""

from __future__ import annotations

from pathlib import Path

from railhil.dbc.contract import DBC, PORTS
from railhil.dbc.read import load_contract
from railhil.dbc.text import dbc_text


def main() -> None:
    """Write ``railhil.dbc`` beside the port table."""
    folder = Path(__file__).parent
    target = folder / DBC
    contract = load_contract(folder / PORTS, check_dbc=False)
    target.write_text(dbc_text(contract), encoding="utf-8")
    print(f"{target.name}: {len(contract.ports)} ports")


if __name__ == "__main__":
    main()
