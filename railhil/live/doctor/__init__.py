"""Examines what timing this machine can provide, one module per subject; each finding says how to improve it.

Every examination takes the root of the file system (a different one in the tests) and changes nothing.
"""
