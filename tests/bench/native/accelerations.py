"""Accelerations by elimination in a loop of compiled code, without calls from Python between them."""

from __future__ import annotations

from stiffmbs.dynamics.elimination.native.eliminated import attempt


def accelerate_often(count, t, acceleration, eliminated):
    """`attempt`, so many times; how many could be done."""
    done = 0
    for _ in range(count):
        done += attempt(t, acceleration, eliminated)
    return done
