"""Natural modes as text."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..analyses.linearised.modes import Modes
from ..linear_analysis.modes import Mode, Motion

MOST_BODIES = 4
LEAST_SHARE = 0.01
"""Part in the kinetic energy above which a body is named."""


def modes_text(found: Modes) -> str:
    """Return a table of modes: frequency, damping, eigenvalues, and the participating bodies."""
    count = found.degrees_of_freedom
    head = f"{found.name or 'model'} at t = {found.t:g} s: {count} degree{'s' if count != 1 else ''} of freedom"
    columns = f"{'':>4}  {'Hz':>12}  {'damping':>10}  {'eigenvalues, 1/s':<28}  kinetic energy"
    rows = []
    for k, mode in enumerate(found.modes, start=1):
        damping = "rigid body" if mode.motion is Motion.RIGID else f"{mode.damping_ratio:.4g}"
        columns_of = f"{k:>4}  {mode.natural_frequency:>12.6g}  {damping:>10}  {_values(mode):<28}"
        rows.append(f"{columns_of}  {', '.join(_bodies(mode))}")
    notes = [f"note: {note}" for note in found.notes]
    return "\n".join([head, *([columns, *rows] if rows else []), *notes])


def _values(mode: Mode) -> str:
    one, *others = mode.eigenvalues
    if mode.motion is Motion.OSCILLATING:
        return f"{one.real:.6g} +- {abs(one.imag):.6g}i"
    return ", ".join(f"{value.real:.6g}" for value in (one, *others))


def _bodies(mode: Mode) -> Iterator[str]:
    if not mode.participation:
        yield "states alone"
    shares = [(name, share) for name, share in mode.participation.items() if share >= LEAST_SHARE]
    for name, share in shares[:MOST_BODIES]:
        yield f"{name} {np.round(100 * share):.0f} %"
    if len(shares) > MOST_BODIES:
        yield f"and {len(shares) - MOST_BODIES} more"
