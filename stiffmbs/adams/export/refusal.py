"""What Adams/Solver has no statement for."""

from __future__ import annotations


class Refusal(Exception):
    """An element or field that a dataset cannot hold; the message says which, and what it can."""
