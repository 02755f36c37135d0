"""Laws for high-speed trains, one a module; :mod:`.base` is what they share."""
