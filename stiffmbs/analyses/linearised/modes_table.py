"""Natural modes as rows and as lines of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...linear_analysis.modes import Mode, Motion

HEADS = ("", "Hz", "damping", "eigenvalues, 1/s", "kinetic energy")
MOST_BODIES = 4
LEAST_SHARE = 0.01
"""Part in the kinetic energy above which a body is named."""


def mode_rows(modes: Sequence[Mode]) -> list[tuple[str, str, str, str, str]]:
    """Return number, natural frequency, damping ratio, eigenvalues and participating bodies of each mode."""
    return [
        (str(k), *_frequency_and_damping(mode), _values(mode), bodies_of(mode.participation))
        for k, mode in enumerate(modes, start=1)
    ]


def mode_lines(modes: Sequence[Mode], most: int | None = None) -> list[str]:
    """Return the lines of a table with its heads; `most` limits the modes, and a last line counts the others."""
    shown = modes[:most]
    left = len(modes) - len(shown)
    lines = [
        f"{k:>4}  {hz:>12}  {damping:>10}  {values:<28}  {bodies}"
        for k, hz, damping, values, bodies in mode_rows(shown)
    ]
    head = [f"{HEADS[0]:>4}  {HEADS[1]:>12}  {HEADS[2]:>10}  {HEADS[3]:<28}  {HEADS[4]}"] if lines else []
    return [*head, *lines, *([f"and {left} more modes"] if left else [])]


def _frequency_and_damping(mode: Mode) -> tuple[str, str]:
    """Return the natural frequency and the damping ratio of a mode, or words where they do not describe the motion."""
    if mode.motion is Motion.APERIODIC and not mode.is_stable:
        return "-", "unstable"
    return f"{mode.natural_frequency:.6g}", "rigid body" if mode.motion is Motion.RIGID else f"{mode.damping_ratio:.4g}"


def _values(mode: Mode) -> str:
    one, *others = mode.eigenvalues
    if mode.motion is Motion.OSCILLATING:
        return f"{one.real:.6g} +- {abs(one.imag):.6g}i"
    return ", ".join(f"{value.real:.6g}" for value in (one, *others))


def bodies_of(participation: Mapping[str, float]) -> str:
    """Return the bodies with the largest parts in the kinetic energy as text."""
    shares = [(name, share) for name, share in participation.items() if share >= LEAST_SHARE]
    named = [f"{name} {np.round(100 * share):.0f} %" for name, share in shares[:MOST_BODIES]]
    more = [f"and {len(shares) - MOST_BODIES} more"] if len(shares) > MOST_BODIES else []
    return ", ".join([*named, *more]) or ("" if participation else "states alone")
