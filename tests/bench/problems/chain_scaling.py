"""Chains of 10 to 10 000 rods of 1 m, 2 s with 201 output points, at rtol 1e-6."""

from __future__ import annotations

from functools import partial

from ..by_hand import chain as hand
from ..scaling import Scaling, Size
from .chain import TIMES, chain, reference

LENGTH = 1.0
MEMORY_OF = (
    "from tests.bench.problems.chain import chain; from stiffmbs.analyses.job import prepare; "
    f"prepare(chain(n, {LENGTH}), rtol=1e-6).integrate()"
)

BENCHMARKS = (
    Scaling(
        "chain_scaling",
        [
            Size(n, partial(chain, n, LENGTH), partial(hand.si2, n, LENGTH), partial(reference, n, LENGTH), rounds)
            for n, rounds in ((10, 9), (100, 5), (1000, 3), (10_000, 1))
        ],
        TIMES,
        MEMORY_OF,
    ),
)
