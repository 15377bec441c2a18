"""Run the fuzzers of single entry points in turn."""

from __future__ import annotations

import importlib
from dataclasses import replace

from ..case import Verdict, tried

WHAT = "each analysis, study and converter in turn against an independent method (runs other fuzzers)"
PAIRS = ("sensitivities", "modes", "transfer", "equilibria", "stability", "studies", "fmu", "convert", "loads", "kc")
"""Fuzzers, each of which compares one entry point with an independent method."""


def trial(seed: int) -> Verdict:
    """Run the fuzzer selected by the seed."""
    name = PAIRS[seed % len(PAIRS)]
    module = importlib.import_module(f".{name}", __package__)
    verdict = tried(lambda: module.trial(seed // len(PAIRS)))
    return replace(verdict, detail=f"{name}: {verdict.detail}")
