"""The systems that come with the bench."""
