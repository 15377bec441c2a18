"""Exception for elements without an equivalent in Adams/Solver."""

from __future__ import annotations


class Refusal(Exception):
    """Element or field without an equivalent in Adams/Solver; the message states both and the alternatives."""
