"""Variational equations along a run of `bdf`: how the motion changes with the numbers of the system."""
