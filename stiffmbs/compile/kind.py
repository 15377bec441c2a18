"""Kinds: elements with the same equations, apart from their numbers, share one kind and one kernel.

An element's fields are split into shapes (the form of its equations) and data (bodies, numbers, tables, rows of
joints). A parameter change therefore never changes a kernel.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ..elements.element import Component, Element, Force, Joint
from ..elements.states.entry import StateValue
from ..elements.states.state_name import StateName, own_state
from ..errors import InputError
from ..reading.formula.formula import Formula
from ..reading.joint_name import JointName
from ..reading.marker import MarkerReference, PlacedMarkers
from ..reading.python_function import PythonFunction
from ..reading.table import Table
from .callbacks import callback_of
from .formula_shape import FormulaShape, Shape
from .machine.layout import whole_lines
from .table_values import spline_data

STATE_RATES = "state_rates"
"""Field of a joint's kind with the rates of the states in its equations."""


class Compilable(Protocol):
    """Interface of a model to the compiler."""

    @property
    def bodies(self) -> Mapping[str, Any]: ...

    @property
    def dimensions(self) -> int:
        """2 for a planar model, 3 for a spatial one."""

    @property
    def joints(self) -> Mapping[str, Joint]: ...

    def joint_at_initial_pose(self, name: str, reader: str = "") -> Joint:
        """Return a joint with its undefined fields taken from the described poses, as the element `reader` reads it."""
        ...

    def elements(self) -> Iterator[tuple[str, Element]]:
        """Yield every joint, force, turn counter and weight with its name."""

    def state_outputs(self) -> Mapping[str, Formula]:
        """Return named formulas used by others."""

    def state_values(self) -> Mapping[str, StateValue]:
        """Return the user's states."""

    def carried(self, marker: Any) -> tuple[str, Any]:
        """Return the body that carries a marker, and its placement on it."""

    def size(self) -> float:
        """Return the size of the mechanism at the start, m."""

    def spin_axes(self) -> Mapping[str, str]:
        """Return the bodies whose quaternions exclude their spin, with the spin axis ``x``, ``y`` or ``z``."""


@dataclass(frozen=True)
class Kind:
    """Structure that elements with one kernel have in common.

    - `element`: class with the equations.
    - `n_bodies`, `n_joints`, `n_states`: bodies that one element acts on, joints that it refers to, and user states that
      it reads or determines.
    - `fields`: fields by name; a shape is the form of a field without its numbers.
    - `spins`: principal axis of each body about which its quaternion does not rotate, ``x``, ``y``, ``z`` or ''; () if
      all quaternions rotate with their bodies, or the equations need no derivative of the pose.
    - `algebraic`: slots of the states without a rate.
    - `n_own`: number of the element's own states, which come first.
    """

    element: type[Element]
    dimensions: int
    n_bodies: int
    n_joints: int
    n_states: int
    fields: tuple[tuple[str, Shape], ...]
    spins: tuple[str, ...]
    algebraic: tuple[int, ...]
    n_own: int

    def holds(self, *forms: str) -> bool:
        """Return True if a field, or one of its values, has one of the given forms."""
        return any(_holds(shape, forms) for _, shape in self.fields)

    @cached_property
    def has_tables(self) -> bool:
        """True if a field, or a formula in it, has a table."""
        return any(_has_tables(shape) for _, shape in self.fields)


def _holds(shape: Shape, forms: tuple[str, ...]) -> bool:
    return shape[0] in forms or (shape[0] == "several" and any(_holds(part, forms) for part in shape[1]))


def _has_tables(shape: Shape) -> bool:
    match shape:
        case ("table",):
            return True
        case ("formula", _, (_, _, n_tables), *_):
            return bool(n_tables)
        case ("several", parts):
            return any(map(_has_tables, parts))
        case ("component", _, fields):
            return any(_has_tables(part) for _, part in fields)
    return False


def with_place(kind: Kind, place: str) -> str:
    """Return the name of a kind, with its place among others in parentheses if known."""
    name = kind.element.kind or kind.element.__name__.lower()
    return f"{name} ({place})" if place else name


@dataclass
class ElementData:
    """Data that distinguish an element from others of its kind.

    - `places`: placement of markers.
    - `name`: name of the element.
    - `bodies`: bodies by slot; the reaction is reported on the first.
    - `numbers`: kernel parameters in the order of use in the kind's equations.
    - `tables`: index in `numbers` of each table's offset, and the table's spline data.
    - `joints`: joints whose multipliers the equations use.
    - `states`: states by slot.
    """

    places: PlacedMarkers
    name: str = ""
    bodies: list[str] = field(default_factory=list)
    numbers: list[Any] = field(default_factory=list)
    tables: list[tuple[int, np.ndarray]] = field(default_factory=list)
    joints: list[str] = field(default_factory=list)
    states: list[str] = field(default_factory=list)

    def slot(self, body: str) -> int:
        """Return the slot of a body; add it if new."""
        if body not in self.bodies:
            self.bodies.append(body)
        return self.bodies.index(body)

    def state_slot(self, state: str) -> int:
        """Return the slot of a state; add it if new."""
        if state not in self.states:
            self.states.append(state)
        return self.states.index(state)

    def flat(self) -> np.ndarray:
        """Return numbers and tables in one array; a table's number is its offset in it.

        Tables begin at a cache line if the array does, and its length is in cache lines.
        """
        numbers = np.array(self.numbers, dtype=float)
        parts = [numbers]
        for at, table in self.tables:
            parts = whole_lines(parts)
            numbers[at] = sum(map(len, parts))
            parts.append(table)
        return np.concatenate(whole_lines(parts) if self.tables else parts)

    def marker_shape(self, marker: MarkerReference) -> Shape:
        """Return the shape of a marker; append its placement to the numbers."""
        body, numbers = self.places[marker]
        self.numbers += numbers
        return ("marker", self.slot(body))


def sorted_out(
    name: str, element: Element, model: Compilable, places: PlacedMarkers | None = None
) -> tuple[Kind, ElementData]:
    """Return an element's kind and data; `places` caches the placement of markers."""
    data = ElementData(PlacedMarkers(model) if places is None else places, name)
    own = element.own_states() if isinstance(element, Force) else ()
    data.states += [own_state(name, state) for state in own]
    fields = _fields(element, model, data)
    values = model.state_values() if data.states else {}
    if isinstance(element, Joint) and data.states:
        fields = (*fields, (STATE_RATES, ("several", tuple(_rates_of_states(values, model, data)))))
    algebraic = tuple(slot for slot, name in enumerate(data.states) if values[name].algebraic)
    counts = len(data.bodies), len(data.joints), len(data.states)
    return Kind(
        type(element), model.dimensions, *counts, fields, _spins(element, model, data), algebraic, len(own)
    ), data


def _spins(element: Element, model: Compilable, data: ElementData) -> tuple[str, ...]:
    """Return `Kind.spins`; only constraints and kinematics, which are differentiated by time, need it."""
    if model.dimensions == 2 or not (isinstance(element, Joint) or getattr(element, "turns", False)):
        return ()
    axes = model.spin_axes()
    if axes.keys().isdisjoint(data.bodies):
        return ()
    return tuple(axes.get(body, "") for body in data.bodies)


def _rates_of_states(values: Mapping[str, StateValue], model: Compilable, data: ElementData) -> Iterator[Shape]:
    """Yield the shapes of the rates of all states that are read, including by these rates."""
    slot = 0
    while slot < len(data.states):
        name = data.states[slot]
        if values[name].algebraic:
            raise InputError(
                f"found the algebraic state '{name}' in a constraint, or in the rate of a state there, expected states with rates: "
                "the constraint has to be differentiated"
            )
        yield _shape(0.0 if values[name].period else values[name].rate, model, data)
        slot += 1


def _fields(element: Element, model: Compilable, data: ElementData) -> tuple[tuple[str, Shape], ...]:
    values = vars(element)  # getattr would call pydantic for each
    return _parts({name: values[name] for name in type(element).__pydantic_fields__}, model, data)


def _parts(values: Mapping[str, object], model: Compilable, data: ElementData) -> tuple[tuple[str, Shape], ...]:
    return tuple((name, _shape(value, model, data)) for name, value in values.items())


def _shape(value: object, model: Compilable, data: ElementData) -> Shape:
    """Return the shape of a field's value; append its data to `data`."""
    match value:
        case MarkerReference():
            return data.marker_shape(value)
        case JointName():
            joint = model.joint_at_initial_pose(value.joint, data.name)
            fields = _fields(joint, model, data)
            data.joints.append(value.joint)
            return ("joint", type(joint), fields, len(data.joints) - 1, value.coordinate_of(joint))
        case StateName():
            return ("state", data.state_slot(value))
        case None | bool() | str():
            return ("choice", value)
        case int() | float():
            data.numbers.append(float(value))
            return ("number",)
        case Formula():
            return FormulaShape(value, model, data, _shape).shape()
        case PythonFunction():
            data.numbers.append(float(callback_of(value).address))
            return ("python",)
        case Table():
            data.tables.append((len(data.numbers), spline_data(value)))
            data.numbers.append(0.0)
            return ("table",)
        case np.ndarray():
            data.tables.append((len(data.numbers), value))
            data.numbers.append(0.0)
            return ("array",)
        case Component():
            return ("component", type(value), _parts(value.in_equations(), model, data))
        case tuple():
            return ("several", tuple(_shape(item, model, data) for item in value))
        case _:
            raise InputError(
                f"found a field with {type(value).__name__}, expected markers, joints' names, numbers, formulas, tables, "
                "words or Python functions"
            )
