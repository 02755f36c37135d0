"""High-speed trains of one or several power units: dynamics, surroundings, plant."""
