"""Forces that elastic elements and dampers have at the start because of how the scene is described.

A mount that is drawn off its place is a stretched spring: its force at the start has no other cause than the drawing. Assembly
closes joints alone, and may stretch the elements between the bodies that it moves. The forces are compared with those in
the static equilibrium, which is only computed if one of them is large, and with the weight of all bodies. The damping force of a mount
has the same cause in the described velocities, if its bodies move relative to each other.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from ..compile.group import Group
from ..compile.system import System
from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.initial import InitialValues
from ..elements.element import Element
from ..errors import StiffmbsError
from ..model.model_data import ModelData
from ..model.scene import Scene
from ..notes import Note, NoteKind
from ..results.energy_balance import potentials

MOUNTS = ("bushing",)
"""Kinds of elements that stand for joints, and are not stretched on purpose."""
OF_EQUILIBRIUM = 10.0
"""Force of a mount at the start, in the largest force of the static equilibrium, above which it is noted."""
OF_WEIGHT = 1000.0
"""Force of any elastic element at the start, in the weight of all bodies, above which it is noted, or a mount's if no equilibrium is found."""
STIFF = 1e-3
"""Deflection of a mount by the weight of all bodies, in sizes of the mechanism, above which it is a spring, and stretched on purpose."""
MOST_MOVES = 100
"""Moves towards the static equilibrium after which it counts as not found: only a note depends on it. Searches that find one take less than half as many
(``tests/analyses/test_start_forces.py``)."""
LAWS = ("spring_law", "law_x", "law_y", "law_z", "law_angle", "law_about_x", "law_about_y", "law_about_z")
"""Fields of elastic elements for forces that are no multiple of the deflection."""
STANDARD_GRAVITY: Final = 9.80665
"""Gravity by which bodies are weighed in scenes without, or with less, m/s^2."""


_STARTS = "'{element}' starts with {force}{deflected}; {compared}{opened}. {remedy}"
DRAWN_LOADED = NoteKind(
    "drawn-loaded",
    _STARTS,
    "The vibration that follows comes from the drawn pose: correct markers and positions, or use 'start: settled', which "
    "starts from the equilibrium",
)
ADDED_LOADED = NoteKind(
    "added-loaded",
    _STARTS,
    "The vibration that follows comes from the pose in which it was added: correct its markers, or add it in a stage of "
    "'analysis: static'",
)
HELD_LOADED = NoteKind(
    "held-loaded", _STARTS, "Bodies are held in a drawn pose that does not fit: correct markers and positions"
)
DAMPED = NoteKind(
    "start-damped",
    "'{element}' starts with {force} of its damping: the initial velocities of its bodies differ there. {remedy}",
    "The first peak of the loads comes from this start: describe velocities that fit, or let a joint in its place hold in 'at_start'",
)


class Stretched(NamedTuple):
    """A force element at a state. `force`: N; a torque over the size of the mechanism."""

    name: str
    kind: str
    elastic: bool
    force: float
    turned: bool = False  # True if the torque is the larger one
    exponent: float = 1.0  # of the force over the deflection; NaN if the force is no power of it

    def deflection(self, energy: float) -> float:
        """Return the deflection of an element with this force and an energy, J, in m; NaN if they do not determine it."""
        return (1.0 + self.exponent) * energy / self.force


def start_force_notes(
    data: ModelData,
    dynamics: Dynamics,
    start: InitialValues,
    t: float,
    rows: OutputRows | None = None,
    before: frozenset[str] | None = None,
) -> Iterator[Note]:
    """Yield a note on the element with by far the largest force that comes from the drawn or assembled pose.

    `rows`: output rows whose first is the start, if known. `before`: elements of the stage before, if there is one; only
    added ones have such forces. A start in an equilibrium has those of bodies that are held.
    """
    is_settled = before is None and isinstance(data, Scene) and data.start != "described"
    if not any(map(_is_elastic, dynamics.system.groups)):
        return
    if rows is None:
        with dynamics.state.unchanged():
            rows = dynamics.report(np.array([t]), start.q[None], start.u[None], True)
    if not len(rows.t):
        return
    system, heavy = dynamics.system, weight(dynamics.system)
    added = [each for each in stretched(system, rows.values[0]) if each.name not in (before or ())]
    for worst in _suspects(system, start, added):
        if worst.kind in MOUNTS and worst.force > OF_EQUILIBRIUM * _at_rest(dynamics, start, t, worst):
            yield DAMPED(worst.name, force=_written(worst.force, worst, system))
            return
        energy = _energy(system, rows, worst.name)
        by_weight = heavy / worst.force * 2.0 * energy / worst.force
        if worst.force > OF_WEIGHT * heavy or by_weight < STIFF * system.size:
            with dynamics.state.unchanged():
                loaded = DRAWN_LOADED if before is None else ADDED_LOADED
                settled = added if is_settled else _in_equilibrium(dynamics, start, t)
                yield from _notes(dynamics, start, t, worst, energy, loaded, settled)
            return


def stretched(system: System, values: np.ndarray) -> list[Stretched]:
    """Return all force elements with a force at a state, from the values of its output terms."""
    found, reported = [], system.reported
    for group in system.groups:
        if group.record.n_equations or not group.kind.element.kind:
            continue
        kind = group.kind.element
        reacts = getattr(kind, "has_reaction", True)
        labels = system.of_body.reactions if reacts else getattr(kind, "channels", ())
        for name, element in zip(group.names, group.elements, strict=True):
            at = [reported.get(f"{name}.{label}", -1) for label in labels]
            parts = np.array([values[k] if k >= 0 else 0.0 for k in at])
            force, torque = _forces(system, parts)
            if max(force, torque) > 0.0:
                larger = max(force, torque), torque > force
                found.append(Stretched(name, kind.kind, _is_elastic(group), *larger, _exponent(element)))
    return found


def _at_rest(dynamics: Dynamics, start: InitialValues, t: float, element: Stretched) -> float:
    """Return the force of an element at the start without velocities, N."""
    with dynamics.state.unchanged():
        rows = dynamics.report(np.array([t]), start.q[None], np.zeros_like(start.u)[None], False)
    found = stretched(dynamics.system, rows.values[0]) if len(rows.t) else [element]
    return next((each.force for each in found if each.name == element.name), 0.0)


def _exponent(element: Element) -> float:
    """Return the exponent of an element's force over its deflection; NaN with a preload or a law."""
    others = (value for name, value in element if name == "preload" or name in LAWS)
    return np.nan if any(value is not None and np.any(value) for value in others) else getattr(element, "exponent", 1.0)


def _energy(system: System, rows: OutputRows, name: str) -> float:
    return float(potentials(system, rows.values[:1])[name][0])


def _is_elastic(group: Group) -> bool:
    """Return True for elements with a stiffness, given or by a method, whose forces come from their poses."""
    element = group.kind.element
    stiff = "stiffness" in element.__pydantic_fields__ or hasattr(element, "stiffness")
    return stiff and bool(group.record.patterns.get("potential"))


def _forces(system: System, parts: np.ndarray) -> tuple[float, float]:
    """Return the force of a reaction, N, and its torque over the size of the mechanism."""
    linear = system.of_body.linear
    return float(np.linalg.norm(parts[:linear])), float(np.linalg.norm(parts[linear:]) / system.size)


def weight(system: System) -> float:
    """Return the weight of all bodies by standard gravity, N."""
    masses = system.mass.reshape(-1, system.of_body.n_u)[:, 0]
    return float(STANDARD_GRAVITY * masses.sum())


def inertia(system: System, u: np.ndarray) -> float:
    """Return the size of the inertia forces of a motion of the bodies relative to each other, N."""
    masses, velocities = (x.reshape(-1, system.of_body.n_u).copy() for x in (system.mass, u))
    linear = slice(0, system.of_body.linear)
    momentum, total = np.sum(masses[:, linear] * velocities[:, linear], axis=0), np.sum(masses[:, linear], axis=0)
    velocities[:, linear] -= np.divide(momentum, total, out=np.zeros_like(total), where=total > 0.0)
    return float(np.sum(masses * velocities**2) / system.size)


def _suspects(system: System, start: InitialValues, elements: list[Stretched]) -> list[Stretched]:
    """Return the elastic elements whose forces weight and motion do not explain, the largest first."""
    if not elements:
        return []
    heavy, moving = weight(system), OF_EQUILIBRIUM * inertia(system, start.u)
    found = [
        each
        for each in elements
        if each.elastic and each.force > max(heavy if each.kind in MOUNTS else OF_WEIGHT * heavy, moving)
    ]
    return sorted(found, key=lambda each: -each.force)


def _notes(
    dynamics: Dynamics,
    start: InitialValues,
    t: float,
    worst: Stretched,
    energy: float,
    loaded: NoteKind,
    settled: list[Stretched],
) -> Iterator[Note]:
    """Yield the note on an element, unless forces of its size act in the equilibrium.

    `loaded`: kind of the note if the equilibrium relieves the element. `settled`: the elements in the equilibrium, if it is found.
    """
    system, heavy = dynamics.system, weight(dynamics.system)
    usual = OF_EQUILIBRIUM * max(each.force for each in settled) if settled else OF_WEIGHT * heavy
    loads = OF_EQUILIBRIUM * max((each.force for each in settled if not each.elastic), default=0.0)
    if not worst.force > min(usual, max(loads, OF_WEIGHT * heavy)):
        return
    at_rest = next((each.force for each in settled if each.name == worst.name), 0.0)
    compared = (
        f"in the static equilibrium it carries {_written(at_rest, worst, system)}"
        if settled
        else f"{worst.force / heavy:.2g} times the weight of all bodies"
    )
    by = _deflected(worst.deflection(energy), worst, system)
    deflected = f"{', ' * bool(by)}{by}, with {energy:.3g} J" if energy > 0 else ""
    kind = loaded if worst.force > OF_EQUILIBRIUM * at_rest else HELD_LOADED
    opened = _by_assembly(dynamics, start, t, worst, energy)
    force = _written(worst.force, worst, system)
    yield kind(worst.name, force=force, deflected=deflected, compared=compared, opened=opened)


def _written(force: float, element: Stretched, system: System) -> str:
    return f"{force * system.size:.3g} N m" if element.turned else f"{force:.3g} N"


def _deflected(deflection: float, element: Stretched, system: System) -> str:
    if np.isnan(deflection):
        return ""
    if element.turned:
        return f"turned by {np.degrees(deflection / system.size):.3g} deg"
    return f"deflected by {1e3 * deflection:.3g} mm"


def _in_equilibrium(dynamics: Dynamics, start: InitialValues, t: float) -> list[Stretched]:
    """Return the elements in the equilibrium near the start; none if it is not found."""
    from ..equilibria.equilibrium import find_equilibrium

    try:
        dynamics.state.q[:] = start.q
        found = find_equilibrium(dynamics, t, most=MOST_MOVES)
        rows = dynamics.report(np.array([t]), found.q[None], found.u[None], False)
    except (StiffmbsError, ArithmeticError, ValueError):
        return []
    return stretched(dynamics.system, rows.values[0]) if len(rows.t) else []


def _by_assembly(dynamics: Dynamics, start: InitialValues, t: float, worst: Stretched, energy: float) -> str:
    """Return a clause if assembly, which closes joints alone, has stretched an element."""
    if not start.moved or not energy > 0.0:
        return ""
    system = dynamics.system
    rows = dynamics.report(np.array([t]), system.q[None], start.u[None], False)
    drawn = [each for each in stretched(system, rows.values[0]) if each.name == worst.name] if len(rows.t) else []
    before = _energy(system, rows, worst.name) if drawn else 0.0
    if not before < energy:
        return ""
    opened = worst.deflection(energy) - (drawn[0].deflection(before) if drawn else 0.0)
    by = _deflected(opened, worst, system).removeprefix("deflected").removeprefix("turned")
    return f"; assembly considers joints only, and has stretched it{by}"
