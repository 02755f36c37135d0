"""What this machine can promise, found out one module per subject; each finding says how to improve it.

Every examination takes the root of the file system (another one in the tests) and changes nothing.
"""
