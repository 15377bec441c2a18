"""Stress tests: extreme or ill-posed models, and the outcome of each: right, told (reported), or wrong."""
