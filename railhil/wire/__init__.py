"""Telegrams of the systems that come with the bench, made from their port tables, and the meaning of their numbers."""
