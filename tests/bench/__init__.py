"""Benchmarks: run time against error, side by side in one process.

A `Problem` has a scene, a reference and contestants, each a way to solve it at a tolerance; a `Scaling` is one problem in
many sizes.  Both are benchmarks, found by the files in `problems`; `report` shows what they measured.
"""
