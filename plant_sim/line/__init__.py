"""The train on a line with stations: doors, docking, holding and emergency brake, timetable, train protection."""
