"""Comparison of solvers on any scene: run time against error, and against a parameter at an equal error.

The reference comes from an implicit and an explicit integrator that agree.
"""
