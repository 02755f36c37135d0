"""Scenarios of the system ``line``: route, stations, timetable, train protection."""
