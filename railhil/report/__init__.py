"""``report.html``: one run, or several laws side by side, in one file that opens offline."""
