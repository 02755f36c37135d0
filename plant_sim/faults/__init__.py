"""Faults inside the plant: of its sensors, actuators and equipment, and of the commands that it takes."""
