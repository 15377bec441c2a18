"""The section `states` of a model: which kinds of entries it takes, and what they have to fit."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

from ...errors import InputError
from ..check_marker import check_marker, listed
from ..formula.field import Formula
from ..formula.names import FormulaNames
from ..marker import GROUND
from ..units.units import CONSTANTS, UNITS
from .state import State

AnyState = State


def refuse_other_meanings(where: str, states: Iterable[str], known: Mapping[str, Collection[str]]) -> None:
    """Refuse states whose names stand for something else in a scene's formulas.

    Parameters
    ----------
    where : str
        In the scene, for messages.
    states : iterable of str
    known : mapping of str to collection of str
        What else formulas name, by section.

    Raises
    ------
    InputError
    """
    for name in states:
        for section, names in known.items():
            if name in names:
                raise InputError(f"{where}.{name}: found a name that {section}.{name} has too, expected another")


def check_states(
    states: Mapping[str, Any],
    bodies: Mapping[str, Any],
    on_ground: Mapping[str, Any],
    names: FormulaNames,
    known: Collection[str] | None,
) -> None:
    """Refuse states whose names have a meaning already, and formulas of what the model does not have.

    Parameters
    ----------
    known : collection of str or None
        All states of the model; None while others may still be added.

    Raises
    ------
    ValueError
    """
    for name, state in states.items():
        if name in UNITS or name in CONSTANTS:
            raise ValueError(f"states.{name}: found the name of a unit or constant, expected another")
        for field, formula in state.formulas():
            where = f"states.{name}.{field}"
            for _, markers in formula.measures():
                for marker in markers:
                    check_marker(where, marker, bodies, on_ground)
            for body in formula.bodies():
                if body not in bodies and body != GROUND:
                    raise ValueError(f"{where}: found the unknown body '{body}', expected {listed(bodies)}")
            if known is not None:
                check_states_of(where, formula, known)
            for reason in names.refused(formula):
                raise ValueError(f"{where}: {reason}")


def check_states_of(where: str, formula: Formula, states: Collection[str]) -> None:
    """Refuse a formula of states that the model does not have."""
    for state in formula.states:
        if state not in states:
            raise ValueError(
                f"{where}: found the unknown name '{state}' in '{formula.text}', expected t, a body's coordinate such as "
                "cart.x, a parameter or a state"
            )
