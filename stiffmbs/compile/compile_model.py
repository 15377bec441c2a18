"""Compilation of a model: elements grouped by kind, kernels cached or generated, equations numbered."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import repeat
from typing import NamedTuple

import numpy as np

from ..elements.body import body_numbers
from ..elements.element import Element
from ..elements.turns import INITIAL_COUNT
from ..errors import InputError
from ..model.model_builder import ModelBuilder
from ..reading.formula.formula import Formula
from ..reading.formula.text import FormulaError
from ..reading.marker import GROUND, PlacedMarkers
from .bodies import BODY_KINDS, BodyKind
from .group import Group
from .kind import Compilable, ElementData, Kind, sorted_out
from .machine.layout import at_a_line
from .machine.routines import renew
from .record import KindRecord, record_of
from .system import System


def compile_model(model: Compilable | ModelBuilder) -> System:
    """Compile a model.

    Parameters
    ----------
    model : Model or Scene

    Returns
    -------
    System
        Interface to solvers: sizes, mass, and the terms of all elements.

    Raises
    ------
    InputError
        If an element's equations cannot be compiled; names the element.
    """
    if isinstance(model, ModelBuilder):
        return compile_model(model.data())
    renew()
    bodies = tuple(model.bodies)
    of_body = BODY_KINDS[model.dimensions]
    numbers, states, size = body_numbers(model.bodies.values()), model.state_values(), model.size()
    sorted_elements = _sorted_elements(model)
    records = {
        kind: _record(kind, members[0].name, f"{k} of {len(sorted_elements)} kinds")
        for k, (kind, members) in enumerate(sorted_elements.items(), start=1)
    }
    rows, equations, holonomic = _rows(sorted_elements, records)
    n_counters = sum(records[kind].n_counters * len(members) for kind, members in sorted_elements.items())
    places = _Places(of_body, bodies, rows, n_counters, tuple(states))
    groups = [_group(kind, records[kind], of_body, members, places) for kind, members in sorted_elements.items()]
    principal_axes = np.empty((len(bodies), 0))
    if model.dimensions == 3:
        principal_axes = np.array([body.principal_axes() for body in model.bodies.values()])
    system = System(
        bodies=bodies,
        states=tuple(states),
        state_scales=np.array([value.scale for value in states.values()]),
        algebraic=np.array([value.algebraic for value in states.values()], dtype=bool),
        sampling=np.array([(value.period, value.offset) for value in states.values()]).reshape(-1, 2),
        of_body=of_body,
        q=np.array([*numbers.coordinates, *[INITIAL_COUNT] * n_counters, *(value.start for value in states.values())]),
        u=np.array(numbers.rates),
        open_rates=np.array(numbers.open_rates),
        mass=np.array(numbers.masses),
        followed=_followed(model, of_body),
        principal_axes=principal_axes,
        groups=tuple(groups),
        equations=tuple(equations),
        holonomic=np.array(holonomic, dtype=bool),
        active=np.ones(len(equations), dtype=bool),
        size=size,
        outputs=_outputs(sorted_elements) if model.state_outputs() else {},
    )
    if system.sampled.any():
        _refuse_jumps_of_positions(system)
    return system


def _outputs(sorted_elements: Mapping[Kind, list[_Member]]) -> dict[str, Formula]:
    """Return the reported formulas by name."""
    from ..elements.states.equation import Reported

    elements = (member for members in sorted_elements.values() for member in members)
    return {name: element.formula for name, element, _ in elements if isinstance(element, Reported)}


def _refuse_jumps_of_positions(system: System) -> None:
    """Refuse sampled states in constraints of positions, which would jump with them."""
    by_states = system.term("tangent", "C_x")
    for row, column in zip(by_states.row, by_states.column, strict=True):
        if column >= system.first_state and system.sampled[column - system.first_state]:
            raise InputError(
                f"'{system.equations[row][0]}': found the sampled state '{system.states[column - system.first_state]}' in a constraint of "
                "positions, which would jump; expected one of velocities, or a state that follows the sampled one"
            )


def kinds_of(model: Compilable) -> list[Kind]:
    """Return the distinct kinds of a model's elements."""
    return list(_sorted_elements(model))


def _sorted_elements(model: Compilable) -> dict[Kind, list[_Member]]:
    sorted_elements: dict[Kind, list[_Member]] = {}
    elements = list(model.elements())
    places = PlacedMarkers(model, [element for _, element in elements])
    for name, element in elements:
        try:
            kind, data = sorted_out(name, element, model, places)
        except (FormulaError, InputError) as error:
            raise InputError(f"{name}: {error}") from None
        sorted_elements.setdefault(kind, []).append(_Member(name, element, data))
    return sorted_elements


def _followed(model: Compilable, of_body: BodyKind) -> np.ndarray:
    """Return 1 for each velocity that drives coordinates, 0 for a body's spin about its axis, shape (n_u,)."""
    followed = np.ones((len(model.bodies), of_body.n_u))
    axes = model.spin_axes() if model.dimensions == 3 else {}
    for k, body in enumerate(model.bodies):
        if body in axes:
            followed[k, of_body.linear + "xyz".index(axes[body])] = 0.0
    return followed.ravel()


class _Member(NamedTuple):
    name: str
    element: Element
    data: ElementData


def _record(kind: Kind, name: str, place: str) -> KindRecord:
    try:
        return record_of(kind, place)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None


def _rows(
    sorted_elements: Mapping[Kind, list[_Member]], records: Mapping[Kind, KindRecord]
) -> tuple[dict[str, int], list[tuple[str, str]], list[bool]]:
    """Return the first row of each joint, and joint, equation name and holonomic flag of each row."""
    first: dict[str, int] = {}
    equations: list[tuple[str, str]] = []
    holonomic: list[bool] = []
    for kind, members in sorted_elements.items():
        record = records[kind]
        for member in members if record.n_equations else ():
            first[member.name] = len(equations)
            equations += zip(repeat(member.name), member.element.equation_names(), strict=False)
            holonomic += [k < record.n_holonomic for k in range(record.n_equations)]
    return first, equations, holonomic


class _Places:
    """Indices of bodies, equations, turn counters and states in a system; counters are assigned consecutively."""

    def __init__(
        self, of_body: BodyKind, bodies: tuple[str, ...], rows: Mapping[str, int], n_counters: int, states: tuple[str, ...]
    ) -> None:  # fmt: skip
        n_q, n_u = of_body.n_q, of_body.n_u
        self.rows = rows
        first_state = n_q * len(bodies) + n_counters
        self._state = {name: first_state + k for k, name in enumerate(states)}
        self._of_body = {name: (n_q * k, n_u * k) for k, name in enumerate(bodies)}
        self._of_body[GROUND] = first_state + len(states), n_u * len(bodies)
        self._counter = n_q * len(bodies)

    def index(self, data: ElementData, first_number: int, n_counters: int) -> list[int]:
        """Return an element's row of `Group.index`."""
        counters = range(self._counter, self._counter + n_counters)
        self._counter += n_counters
        bodies = (place for body in data.bodies for place in self._of_body[body])
        states = (self._state[name] for name in data.states)
        return [*bodies, first_number, *(self.rows[joint] for joint in data.joints), *states, *counters]


def _group(kind: Kind, record: KindRecord, of_body: BodyKind, members: list[_Member], places: _Places) -> Group:
    numbers = [member.data.flat() for member in members]
    starts = np.cumsum([0, *(len(own) for own in numbers)])
    index = [
        places.index(member.data, start, record.n_counters) for member, start in zip(members, starts, strict=False)
    ]
    aligned = at_a_line(starts[-1] + 1)
    np.concatenate(numbers, out=aligned[:-1])
    return Group(
        kind, record, of_body, tuple(m.name for m in members), [m.element for m in members],
        np.array(index, dtype=np.int64), aligned,
        places.rows[members[0].name] if record.n_equations else 0,
    )  # fmt: skip
