"""High-speed trains under speed control: systems, task, target curve and emergency profile."""
