"""Stiffness and damping, and what IDA makes of them."""
