"""A recorded run as files of other tools: MF4, MCAP, Parquet, CSV, BLF, ASC."""
