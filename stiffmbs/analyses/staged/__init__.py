"""Consecutive runs, each from the final state of the previous one."""
