"""Drives and forces with kinks at known times: seeds of the fuzzer `kinks`, which names solver, tolerance and scene."""

from __future__ import annotations

from functools import partial

from ...case import Case
from ...fuzzers.kinks import trial

SEEDS = range(40)

CASES = tuple(
    Case(f"kinks_of_seed_{seed}", "a chain of bodies against minimal equations from kink to kink", partial(trial, seed))
    for seed in SEEDS
)
