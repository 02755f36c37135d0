"""``railhil audit``: what fixed point (or float32) does to a control law, against the same law in float64."""
