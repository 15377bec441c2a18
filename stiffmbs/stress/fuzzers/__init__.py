"""Random cases without end: each module has `WHAT` and `trial(seed)`."""
