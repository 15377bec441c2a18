"""Variational equations along a run of `bdf`: derivatives of the motion with respect to parameters."""
