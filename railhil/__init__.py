"""railhil: a hardware-in-the-loop bench for train controllers."""
