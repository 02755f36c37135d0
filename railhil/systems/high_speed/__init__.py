"""How runs of high-speed trains are judged and shown."""
