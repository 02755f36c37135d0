"""``railhil audit``: compares a control law in fixed point (or float32) with the same law in float64."""
