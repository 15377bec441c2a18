"""Models linearised about a state: natural modes, mode shapes, transfer functions."""
