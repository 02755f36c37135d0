"""Telegrams of the systems that come with the bench, made from their port tables, and what their numbers mean."""
