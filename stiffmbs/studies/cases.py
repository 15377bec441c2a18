"""Cases of a study: a full grid, or a sample."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..reading.variation import MOST_VALUES, Variation

MOST_CASES = MOST_VALUES


@dataclass(frozen=True)
class Cases:
    """Cases of a study."""

    variations: tuple[Variation, ...]
    drawn: tuple[tuple[object, ...], ...] = ()  # values of each variation of a sample, case by case; empty for a grid

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the varied parameters or paths."""
        return tuple(one.name for one in self.variations)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each variation of a grid, or number of cases of a sample."""
        return (len(self.drawn[0]),) if self.drawn else tuple(len(one.values) for one in self.variations)

    def __len__(self) -> int:
        return math.prod(self.shape)

    def __iter__(self) -> Iterator[tuple[object, ...]]:
        """Iterate over the values of the cases, in the order of `names`; in a grid the last varies fastest."""
        if self.drawn:
            return zip(*self.drawn, strict=True)
        return itertools.product(*(one.values for one in self.variations))


def cases_of(variations: Sequence[Variation], sample: str | None = None, seed: int = 0) -> Cases:
    """Return the cases of variations.

    `sample`: ``lhs:500``, ``sobol:512`` or ``random:500``; the full grid by default. `seed`: seed of the sample, which
    is reproducible. Raises InputError if a name occurs twice, a range of a grid has no count, there are too many cases,
    or the sample is invalid.
    """
    names = [one.name for one in variations]
    if not names:
        raise InputError("study: found nothing to vary, expected one parameter or more")
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{name}: found two variations of it, expected one")
    if sample is not None:
        return Cases(tuple(variations), _drawn(variations, sample, seed))
    for one in variations:
        if not one.values:
            raise InputError(
                f"{one.name}: found a range without a count, expected one for a grid, or a sample such as lhs:500"
            )
    cases = Cases(tuple(variations))
    if len(cases) > MOST_CASES:
        raise InputError(f"study: found {len(cases):.3g} cases, expected at most {MOST_CASES:.0e}")
    return cases


def _drawn(variations: Sequence[Variation], sample: str, seed: int) -> tuple[tuple[object, ...], ...]:
    match = re.fullmatch(r"(random|lhs|sobol):(\d+)", sample)
    if match is None or not 1 <= int(match[2]) <= MOST_CASES:
        raise InputError(f"sample: found '{sample}', expected one of random:N, lhs:N, sobol:N")
    points = _points(match[1], int(match[2]), len(variations), seed)
    return tuple(one.drawn(points[:, k]) for k, one in enumerate(variations))


def _points(kind: str, count: int, width: int, seed: int) -> np.ndarray:
    """Return points of the unit cube, shape (count, width)."""
    if kind == "random":
        return np.random.default_rng(seed).random((count, width))
    from scipy.stats import qmc

    if kind == "lhs":
        return np.asarray(qmc.LatinHypercube(width, rng=seed).random(count))
    engine = qmc.Sobol(width, rng=seed)
    return np.asarray(engine.random_base2(math.ceil(math.log2(count)))[:count])
