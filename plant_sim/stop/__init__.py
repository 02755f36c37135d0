"""A train that stops at a platform: its brake and motion, what is drawn for it, its own watch."""
