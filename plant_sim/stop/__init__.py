"""A train that stops at a platform: its brake and motion, its random draws, its own watch."""
