"""Loads at which a tyre of the Magic Formula adds energy: slip stiffnesses and relaxation lengths of the wrong sign."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .coefficients import TyreProperties

WITHOUT_LIMIT = 1.5
"""Largest load that is checked of a file without FZMAX, in nominal loads: that of the default curves of a tyre."""
LOADS = 401
"""Number of loads that are checked."""
COEFFICIENTS = {"Kxk": "PKX1 and PKX2", "Kya": "PKY1, PKY2, PKY3 and PKY4"}
"""Coefficients that decide the sign of a stiffness."""


def active_notes(tyre: TyreProperties) -> Iterator[str]:
    """Yield a note for each stiffness or relaxation length that has the wrong sign within the tyre's own range.

    Loads range from FZMIN to FZMAX. Pressures are that of the file, PRESMIN and PRESMAX, and cambers are 0, CAMMIN and
    CAMMAX.
    """
    p = SimpleNamespace(**tyre.numbers)
    most = tyre.coefficients.get("FZMAX", WITHOUT_LIMIT * p.FNOMIN)
    least = max(tyre.ranges.get("load", (0.0, 0.0))[0], most / LOADS)
    loads = np.linspace(least, most, LOADS)
    limit = f"FZMAX = {most:g}" if "FZMAX" in tyre.coefficients else f"{WITHOUT_LIMIT:g} FNOMIN = {most:g}"
    pressures, cambers = _pressures(tyre), (0.0, *tyre.ranges.get("camber", ()))
    conditions = [(pressure, camber) for pressure in pressures or (None,) for camber in cambers]
    for name, values in _expected_positive(tyre, p, loads, pressures, cambers).items():
        wrong = values < 0
        if not wrong.any():
            continue
        k = int(np.argmin(np.where(wrong.any(axis=1), np.argmax(wrong, axis=1), LOADS)))  # wrong from the least load on
        low, high = (f"{load:.5g} N" for load in loads[wrong[k]][[0, -1]])
        range = f"between {low} and {high}{_at(*conditions[k], conditions[0])}, within its own range up to {limit} N"
        first = int(np.argmax(wrong[k]))
        until = f"set FZMAX to {loads[first - 1]:.4g} N or less, or " if first else ""
        if name in COEFFICIENTS:
            sign = "negative" if name == "Kxk" else "positive (ISO axes)"
            yield (
                f"{name} is {sign} {range}: the force of the tyre adds energy to a slipping wheel there, and runs may "
                f"diverge; {until}correct {COEFFICIENTS[name]}"
            )
        else:
            yield f"the relaxation length {name} is negative {range}: runs use 0.01 m there; {until}correct its coefficients"


def _at(pressure: float | None, camber: float, usual: tuple[float | None, float]) -> str:
    """Return the pressure and camber of a condition that are not the usual ones, as a clause."""
    parts = [f"a pressure of {pressure:.4g} Pa"] if pressure != usual[0] else []
    parts += [f"a camber of {camber:.3g} rad"] if camber != usual[1] else []
    return f" at {' and '.join(parts)}" if parts else ""


def _expected_positive(
    tyre: TyreProperties, p: SimpleNamespace, loads: np.ndarray, pressures: Sequence[float], cambers: Sequence[float]
) -> Mapping[str, np.ndarray]:
    """Return values that a passive tyre has above zero, up to positive factors, by name; shape (conditions, loads)."""
    is_6 = tyre.formula.is_6
    dpi = np.array([x / _nominal(tyre) - 1 for x in pressures] or [0.0])[:, None, None]
    gamma = np.array(cambers)[:, None]
    full = p.FNOMIN * p.LFZO
    dfz = (loads - full) / full
    upright = 1 - p.PKY3 * np.abs(gamma if is_6 else gamma * p.LGAY)
    peak = (p.PKY2 + (p.PKY5 * gamma**2 if is_6 else 0.0)) * (1 + p.PPY2 * dpi)
    shape = np.sin((p.PKY4 if is_6 else 2.0) * np.arctan(loads / full / peak))
    of_pressure = 1 + p.PPX1 * dpi + p.PPX2 * dpi**2
    found = {
        "Kxk": (p.PKX1 + p.PKX2 * dfz) * of_pressure * p.LKX + 0 * gamma,
        "Kya": -p.PKY1 * (1 + p.PPY1 * dpi) * shape * upright * p.LKY,
    }
    if tyre.is_transient and is_6:
        found["sigma_x"] = (1 + p.PCFX1 * dfz + p.PCFX2 * dfz**2) * (1 + p.PCFX3 * dpi) + 0 * gamma
        found["sigma_y"] = (1 + p.PCFY1 * dfz + p.PCFY2 * dfz**2) * (1 + p.PCFY3 * dpi) + 0 * gamma
    elif tyre.is_transient:
        found["sigma_x"] = p.PTX1 + p.PTX2 * dfz + 0 * gamma + 0 * dpi
        found["sigma_y"] = p.PTY1 * np.sin(2 * np.arctan(loads / (p.PTY2 * full))) * upright + 0 * dpi
    return {name: values.reshape(-1, len(loads)) for name, values in found.items()}


def _pressures(tyre: TyreProperties) -> tuple[float, ...]:
    """Return the pressure of the file and the ends of its valid range, Pa; nothing for a tyre without pressure."""
    own = tyre.nominal_pressure
    return () if own is None else (own, *tyre.ranges.get("pressure", ()))


def _nominal(tyre: TyreProperties) -> float:
    """Return the pressure to which the increment refers, Pa."""
    return float(tyre.in_equations()["NOMPRES"])  # type: ignore[arg-type]
