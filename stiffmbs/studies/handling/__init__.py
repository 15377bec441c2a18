"""Handling and ride: metrics of the standards, and the tests that measure them on a scene."""
