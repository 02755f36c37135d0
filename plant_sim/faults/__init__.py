"""Faults that live in the plant: of its sensors, its actuators, its equipment and of the commands that it takes."""
