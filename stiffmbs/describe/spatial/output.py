"""Requests in space: formulas that are only reported, of everything that a run knows.

Besides what the formulas of elements may hold (`stiffmbs.describe.formula.names.SPACE`) they measure accelerations and
angles, ask for what joints and forces do, and read other channels.  They are evaluated after the run, so that none of
them is compiled.  How they are read is in `stiffmbs.describe.spatial.output_field`.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..element import JointName
from ..formula.names import SPACE
from ..marker import MarkerReference
from ..model_data import ModelData, check_marker
from ..table import Table
from ..units.units import Quantity

ACCELERATIONS = ("accx", "accy", "accz", "accm", "wdtx", "wdty", "wdtz", "wdtm")
ANGLES = ("psi", "theta", "phi", "q0", "q1", "q2", "q3")
"""Body-fixed turns about z, x and z, and the quaternion, of one marker against another."""
MEASURES = tuple(dict.fromkeys((*SPACE.position_measures, *SPACE.velocity_measures, *ACCELERATIONS, *ANGLES)))
"""Between two markers, those of `ALONG_AXES` perhaps along the axes of a third."""
ALONG_AXES = (*SPACE.along_axes, "accx", "accy", "accz", "wdtx", "wdty", "wdtz")
COUNTED_ANGLES = ("ax", "ay", "az")
"""The angles that count whole turns."""
ACTIONS = ("fx", "fy", "fz", "fm", "tx", "ty", "tz", "tm")
"""Force and torque of a joint or force on its first body, or on its second (``hinge.j``), along ground axes or those of a
marker: ``fx(hinge)``, ``tz(hinge.j, bar.end)``; fm and tm are their sizes."""

OF_BODIES = (*SPACE.positions, *SPACE.velocities, "ax", "ay", "az", "wdx", "wdy", "wdz")
OF_ELEMENTS = ("fx", "fy", "fz", "tx", "ty", "tz")
"""The channels that a formula may read."""


@dataclass(frozen=True)
class Term:
    """A measure or an action in a formula.

    Attributes
    ----------
    function : str
        One of `MEASURES` or `ACTIONS`.
    element : str
        Of an action: the joint or force.
    on_second : bool
        Whether what it does to its second body is meant.
    markers : tuple of MarkerReference
        Of a measure i and j, and the marker whose axes it is along, if any; of an action that marker alone, if any.
    """

    function: str
    element: str
    on_second: bool
    markers: tuple[MarkerReference, ...]

    def __str__(self) -> str:
        """As in a formula: ``az(bar.end, ground)``."""
        element = [f"{self.element}.j" if self.on_second else self.element] if self.element else []
        return f"{self.function}({', '.join([*element, *(marker.label for marker in self.markers)])})"


def placeholder(k: int) -> str:
    """The name in a formula's tree that stands for its k-th term: none that could be written, as it has a space in it."""
    return f"term {k}"


@dataclass(frozen=True, eq=False)
class Output:
    """A checked formula of a request.

    Attributes
    ----------
    text : str
        As written.
    tree : ast.expr
        Its tree with the names of `placeholder` in place of `terms`.
    terms : tuple of Term
    values : mapping of str to float
        The scene's parameters, units and constants that it uses, in SI units.
    tables : mapping of str to Table
        The scene's tables that it calls.
    parameters : mapping of str to Quantity
        The scene's parameters among `values`, with their dimensions.
    expanded : str
        The text with the scene's variables in their places; empty where the scene has none.
    """

    text: str
    tree: ast.expr
    terms: tuple[Term, ...]
    values: Mapping[str, float]
    tables: Mapping[str, Table]
    parameters: Mapping[str, Quantity] = field(default_factory=dict)
    expanded: str = ""

    def channels(self) -> Iterator[tuple[str, str]]:
        """The channels that it reads, as (owner, component)."""
        for node in ast.walk(self.tree):
            match node:
                case ast.Attribute(ast.Name(owner), name) if f"{owner}.{name}" not in self.values:
                    yield owner, name

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Output) and all(
            getattr(self, part) == getattr(other, part) for part in ("text", "values", "tables")
        )

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"Output({self.text!r})"


def ends(element: str, model: ModelData) -> tuple[Any, Any]:
    """The markers i and j of a joint or force, of a drive those of the joint that it drives; None where it has none."""
    acting: Any = {**model.joints, **model.forces}[element]
    for _, joint in acting.parts(JointName):
        acting = model.joints[joint.joint]
        break
    return getattr(acting, "i", None), getattr(acting, "j", None)


def check_output(where: str, output: Output, model: ModelData) -> None:
    """Refuse a formula that names an unknown body, marker, joint, force or channel."""
    acting = {**model.joints, **model.forces}
    for term in output.terms:
        for marker in term.markers:
            check_marker(where, marker, model.bodies, model.markers)
        if term.element and term.element not in acting:
            raise ValueError(f"{where}: found '{term.element}' in '{output.text}', expected a joint or a force")
        if term.on_second and None in ends(term.element, model):
            raise ValueError(f"{where}: found '{term.element}.j' in '{output.text}', which has no marker j")
    for owner, name in output.channels():
        known = OF_BODIES if owner in model.bodies else OF_ELEMENTS if owner in acting else ()
        if name not in known:
            raise ValueError(
                f"{where}: found '{owner}.{name}' in '{output.text}', expected a channel of a body, a joint or a force"
            )
