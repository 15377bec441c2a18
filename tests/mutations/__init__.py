"""Mutation tests: small semantic changes of the package, each of which the nearest tests must detect.

Run them with ``python -m tests.mutations [--count 300] [--seed 1] [--area joints]``.
"""
