"""Runs one after the other, each from the state in which the one before it ends."""
