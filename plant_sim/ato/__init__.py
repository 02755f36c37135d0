"""A train under automatic train operation: motion, sensors, equipment, its watch."""
