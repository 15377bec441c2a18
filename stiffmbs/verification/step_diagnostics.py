"""Doubts about a run from sampling along it and from a rerun with shorter steps, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..results.energy_balance_notes import CERTAIN
from ..results.scales import kind_of
from .diagnostics import Comparison
from .divergence import distance, divergence
from .solve_again import Again
from .stepped_over import Along, SteppedOver


def step_diagnostics(comparison: Comparison, along: Along, shorter: Again | None) -> Iterator[str]:
    """Yield a sentence on missed events, else on different runs with shorter steps, else on an open energy balance.

    Parameters
    ----------
    comparison : Comparison
        Of the run with others.
    along : Along
        Result of sampling along the run.
    shorter : Again or None
        Rerun with a shorter longest step.
    """
    if along.stretches:
        yield _stepped_over(comparison, along.stretches[0], shorter)
        return
    if by_luck(comparison, shorter):
        assert shorter is not None
        yield (
            "runs part by what their steps see of the scene's laws, not by their tolerance: this one agrees with "
            f"{shorter.name}, others do not; set max_step to that, so that it is not left to luck"
        )
        return
    different = _different(comparison, shorter)
    if shorter is not None and different:
        yield (
            f"the length of the steps decides: {different} in {shorter.name}, though a tighter tolerance alone changes less; "
            "set max_step to that, and to less until two runs agree"
        )
    elif along.balance is not None and not any("energy balance" in note for note in comparison.first.notes):
        yield from _open_balance(along)


def by_luck(comparison: Comparison, shorter: Again | None) -> bool:
    """Return True if a run agrees with one of shorter steps, but not with others."""
    if not any(comparison.divergences()) or not _whole(shorter):
        return False
    return not _parts(comparison, comparison.first.channels, shorter)


def _whole(shorter: Again | None) -> bool:
    return shorter is not None and shorter.solution is not None and not shorter.obstacle and not shorter.remark


def _parts(comparison: Comparison, channels: Mapping[str, np.ndarray], shorter: Again | None) -> str:
    """Return a clause on the divergence from the motion with shorter steps, or an empty string."""
    assert shorter is not None
    first = comparison.first
    other = {name: shorter.reported(name) for name in first}
    found = divergence(first.time, distance(channels, other, len(first.time), comparison.sizes))
    return f"from t = {found.t:.4g} s on {found.body} is elsewhere" if found is not None else ""


def _stepped_over(comparison: Comparison, found: SteppedOver, shorter: Again | None) -> str:
    whose = f"'{found.element}' acts" if found.element else "something acts"
    known = _off(comparison, shorter) or "how far all is off from there on is not known, and nothing has a bar"
    return (
        f"stepped over: {whose} at t = {found.at:.6g} s within a step of the solver, which goes on as if it did not; {known}; "
        f"set max_step to {found.max_step:.1g} s or less"
    )


def _off(comparison: Comparison, shorter: Again | None) -> str:
    """Return a clause on the channel that differs most from a run with shorter steps; empty if that stopped early."""
    if shorter is None or shorter.solution is None or shorter.obstacle:
        return ""
    parts = {
        name: float(np.nanmax(np.abs(comparison.first[name] - shorter.reported(name)), initial=0.0)) / size
        for name, size in comparison.sizes.items()
        if size and kind_of(name) in ("velocity", "angular velocity", "position", "angle")
    }
    name = max(parts, key=lambda each: parts[each], default="")
    if not name:
        return ""
    unit = comparison.first.unit(name)
    return f"{name} is off by up to {parts[name] * comparison.sizes[name]:.3g} {unit} ({shorter.name})"


def _different(comparison: Comparison, shorter: Again | None) -> str:
    """Return a clause on the divergence of shorter steps from a run of their tolerance that agrees with the first."""
    if not _whole(shorter) or not comparison.tighter or any(comparison.divergences()):
        return ""
    tight = {name: comparison.tighter[-1].reported(name) for name in comparison.first}
    if len(tight["energy.total"]) < len(comparison.first.time):
        return ""
    return _parts(comparison, tight, shorter)


def _open_balance(along: Along) -> Iterator[str]:
    balance = along.balance
    assert balance is not None
    if balance.imbalance > max(along.missing, CERTAIN * balance.resolved):
        k = int(np.argmax(np.abs(balance.open)))
        yield (
            f"the energy balance is broken: {balance.imbalance:.3g} J of the {balance.scale:.3g} J exchanged are missing at "
            f"t = {balance.t[k]:.6g} s; tighten rtol or set max_step"
        )
