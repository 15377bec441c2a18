"""Inputs as functions of time: features, breakpoints and ends."""
