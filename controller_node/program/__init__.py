"""A law recorded once as a list of operations, for cycles, telemetry, audit and the C export."""
