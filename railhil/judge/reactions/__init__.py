"""The fault catalogue: what is injected, what the watches must do, and the table of what they did."""
