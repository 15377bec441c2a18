"""Kinds of features that a random scene may have."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Features:
    """Features that a random scene may have; all by default.

    Attributes
    ----------
    loops : bool
        Joints that close loops, and relations between the coordinates of joints.
    redundant : bool
        Joints with redundant equations.
    time : bool
        Drives and formulas of t.
    events : bool
        Forces with breakpoints in the state: contacts, stops, ``max``.
    states : bool
        States, algebraic states, filters and linear systems.
    velocities : bool
        Initial velocities; bodies are at rest without them.
    nonholonomic : bool
        Nonholonomic constraints.
    friction : bool
        Friction in joints, which depends on their reactions.
    tyres : bool
        Wheels with tyres on roads.
    parts : bool
        Library parts of the package.
    inputs : bool
        Inputs from other programs.
    """

    loops: bool = True
    redundant: bool = True
    time: bool = True
    events: bool = True
    states: bool = True
    velocities: bool = True
    nonholonomic: bool = True
    friction: bool = True
    tyres: bool = True
    parts: bool = True
    inputs: bool = True

    def has(self, needs: tuple[str, ...]) -> bool:
        """Return True if all the named features are allowed."""
        return all(getattr(self, name) for name in needs)


ALL = Features()
TREE = Features(loops=False, redundant=False)
SMOOTH = Features(events=False, friction=False, tyres=False, parts=False)
STATIC = Features(
    time=False, events=False, velocities=False, nonholonomic=False, friction=False, tyres=False, parts=False, inputs=False
)  # fmt: skip
