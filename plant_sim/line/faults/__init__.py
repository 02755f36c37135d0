"""Faults of a train on a line: doors, docking loop, brakes, track side and train protection."""
