"""Requirements of a run as sentences: their language, their time, and the margin by which a record keeps them."""
