"""Fuzzers, one per file: `WHAT` says what a trial tries, `trial` makes one random case from a seed and judges it."""
