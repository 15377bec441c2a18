"""Every analysis against an independent method, in turn: the seeds go round the fuzzers of single entry points."""

from __future__ import annotations

import importlib
from dataclasses import replace

from ..case import Verdict, tried

WHAT = "each analysis, study and converter in turn against an independent method (the fuzzers of single entry points)"
PAIRS = ("sensitivities", "modes", "transfer", "equilibria", "stability", "studies", "fmu", "convert", "loads", "kc")
"""Fuzzers, each of which compares one entry point with an independent method."""


def trial(seed: int) -> Verdict:
    """Try the fuzzer whose turn it is."""
    name = PAIRS[seed % len(PAIRS)]
    module = importlib.import_module(f".{name}", __package__)
    verdict = tried(lambda: module.trial(seed // len(PAIRS)))
    return replace(verdict, detail=f"{name}: {verdict.detail}")
