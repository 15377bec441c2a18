"""Published plates and shells, with elements of half the size from row to row."""

from tests.bench.shells import Shells

BENCHMARKS = [Shells("shells")]
