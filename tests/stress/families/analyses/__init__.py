"""Analyses about a state: modes, transfer functions, stability."""
