"""An emulated serial CAN adapter: slcan protocol on a pseudo-terminal, any python-can interface behind it."""
