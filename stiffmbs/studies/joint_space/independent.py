"""Independent coordinates, and models that have none."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...compile.system import System
from ...errors import InputError
from ...reading.did_you_mean import instead_of


def named(what: str, names: Sequence[str] | None) -> list[str]:
    """Return a list of names; raise an InputError if it is a text or no list."""
    if isinstance(names, str):
        raise InputError(f"{what}: found the text '{names}', expected a list of names")
    try:
        return [] if names is None else list(names)
    except TypeError:
        raise InputError(f"{what}: found {names!r}, expected a list of names") from None


def places_in(given: list[str], names: tuple[str, ...], count: int) -> list[int]:
    """Return the places of independent coordinates; raise an InputError if one is unknown, or their number is wrong."""
    for name in given:
        if name not in names:
            raise InputError(f"independent: found '{name}'{instead_of(name, names)}")
    if len(given) != count:
        raise InputError(
            f"independent: found {len(given)} coordinates, expected {count}, one for each degree of freedom"
        )
    return [names.index(name) for name in given]


def order_of(rates: tuple[str, ...], n_joints: int, kept: list[int]) -> list[int]:
    """Return the rates in the order in which they become dependent: of free bodies first, kept ones last."""
    linear = [k for k in range(n_joints, len(rates)) if rates[k].rpartition(".")[2].startswith("v")]
    angular = [k for k in range(n_joints, len(rates)) if k not in linear]
    order = [*linear[::-1], *angular[::-1], *range(n_joints)[::-1]]
    return [*(k for k in order if k not in kept), *kept]


def refuse_others(system: System) -> None:
    """Raise an InputError if forces depend on reactions, or a state has no rate."""
    if system.forces_by_reactions:
        raise InputError(
            f"forces.{system.forces_by_reactions[0]}: its forces depend on reactions of joints, such as friction, which no function of q and v "
            "has; expected forces of positions, velocities and states"
        )
    if system.algebraic.any():
        raise InputError(
            f"states.{system.states[int(np.argmax(system.algebraic))]}: found a state without a rate, expected rates"
        )


def refuse_velocities(system: System, loops: np.ndarray) -> None:
    """Raise an InputError if a joint outside the tree depends on time, or has no position form."""
    wrong = np.flatnonzero(loops & (system.timed | ~system.holonomic))
    if len(wrong):
        raise InputError(
            f"joints.{system.equations[int(wrong[0])][0]}: its equations depend on time or states, or constrain velocities only; expected a joint "
            "that constrains positions, or a drive"
        )
