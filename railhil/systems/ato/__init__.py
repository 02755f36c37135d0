"""A train that drives automatically from one stop to the next, with one notch."""
