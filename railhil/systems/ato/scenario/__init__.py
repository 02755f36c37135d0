"""The scenarios of ``ato``: train, line, target speed curve, plan and limits."""
