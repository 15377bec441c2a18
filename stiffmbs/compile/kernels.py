"""Compiled kernels of a kind."""

from __future__ import annotations

from .kind import Kind, with_place
from .machine.compiler import Compiled, compiled_source
from .record import RARE, source_of
from .terms import KERNEL_SIGNATURE, TERM_SETS


def kernel_of(kind: Kind, term_set: str, place: str = "") -> Compiled | None:
    """Return the compiled kernel of a kind for a set of terms, or None; `place` as for `record_of`."""
    source = source_of(kind, term_set)
    return compiled_source(source, "kernel", KERNEL_SIGNATURE, with_place(kind, place)) if source else None


def compile_usual(kind: Kind) -> None:
    """Compile and cache all kernels of a kind that solvers commonly use."""
    for term_set in TERM_SETS:
        if term_set not in RARE:
            kernel_of(kind, term_set)
