"""Controllers in C in a folder: functions of a user with the C around them, and exports."""
