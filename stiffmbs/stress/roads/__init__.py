"""Vehicles on roads of straight lines, and an independent integration of a wheel on one."""
