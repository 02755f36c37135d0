"""Judging of a run over a line: stations, timetable, train protection, scores."""
