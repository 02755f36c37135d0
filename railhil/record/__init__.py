"""The record of a run: its files, written by the supervisor while the run is made, and their telegrams read back."""
