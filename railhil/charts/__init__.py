"""Charts of the report and of the panel: uPlot and what both pages draw with it.

``static/`` holds uPlot 1.6.32 (MIT, its licence beside it) as published; ``SHA256SUMS`` are the digests of its files.
"""
