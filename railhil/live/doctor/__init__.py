"""Examines the timing that this machine can provide, one module per subject; each finding gives a remedy.

Every examination takes the root of the file system (a different one in the tests) and changes nothing.
"""
