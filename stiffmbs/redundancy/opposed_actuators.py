"""Controllers that act on a motion prescribed by a drive: their force changes only the reaction of the drive."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from ..compile.quaternions import rotated
from ..compile.state import State
from ..compile.system import System
from ..compile.terms import TERM_SETS
from ..notes import Note, NoteKind
from ..reading.formula.formula import Formula
from ..solve.trajectory import Grid
from .listed import listed
from .parameters import REDUNDANCY

if TYPE_CHECKING:
    from ..elements.element import Force
    from ..model.model_data import ModelData


OPPOSED = NoteKind(
    "opposed-actuator",
    "{element} acts on a motion that {drives} {prescribe}, so it changes only the reaction of {drives}",
    "remove one of them",
)


def opposed_notes(system: System, data: ModelData, q: np.ndarray, grid: Grid) -> tuple[Note, ...]:
    """Return a note on each controller whose force has a component along the free motions only without the drives.

    A controller is a force that depends on time or states, and that measures motion directly or through states. The
    reaction of a drive to springs, dampers and forces of time alone is a common result. A force on a body is assumed to
    act on bodies connected to it by bushings as well, such as the housing of a rack. `data`: model from which the
    system was compiled. `q`: an assembled pose. `grid`: output times of the run.
    """
    drives = [name for name, joint in data.joints.items() if joint.kind == "drive"]
    controllers = [name for name, force in data.forces.items() if drives and _measures(force, data)]
    if not controllers or system.has_functions:  # a Python function may reject arbitrary states
        return ()
    found = _Directions(State(system), q, (grid.start, grid.end))
    rows = {name: found.rows_of(name) for name in drives}
    everything = found.space(())
    undriven = cache(lambda: found.space(chain(*rows.values())))
    held = _held_by_bushings(data, system)
    notes = []
    for name in controllers:
        for direction in (moved for own in found.of(name) for moved in found.elsewhere(own, held)):
            if _lies_in(direction, everything) and not _lies_in(direction, undriven()):
                needed = [drive for drive in drives if not _lies_in(direction, found.space(rows[drive]))]
                by = needed or drives
                notes.append(OPPOSED(name, drives=listed(by), prescribe="prescribes" if len(by) == 1 else "prescribe"))
                break
    return tuple(notes)


def _measures(force: Force, data: ModelData) -> bool:
    """Return True if a formula of a force, or of the states that it uses, measures motion."""
    named = {full: value.rate for name, state in data.states.items() for full, value in state.values(name)}
    named |= data.state_outputs()
    pending, seen = [formula for _, formula in force.parts(Formula)], set[str]()
    while pending:
        formula = pending.pop()
        if any(formula.measures()) or any(formula.coordinates()):
            return True
        pending += [x for name in {*formula.states} - seen if isinstance(x := named.get(name), Formula)]
        seen |= {*formula.states}
    return False


def _held_by_bushings(data: ModelData, system: System) -> dict[int, set[int]]:
    """Return the bodies connected to each body by bushings; the ground has the number of bodies as its index."""
    number = {name: k for k, name in enumerate(system.bodies)}
    held: dict[int, set[int]] = {}
    for force in data.forces.values():
        if force.kind == "bushing":
            a, b = (number.get(marker.body, len(number)) for _, marker in [*force.markers()][:2])
            held.setdefault(a, set()).add(b)
            held.setdefault(b, set()).add(a)
    return held


class _Directions:
    """Directions in velocity space, with lengths in units of the system's size."""

    def __init__(self, state: State, q: np.ndarray, times: tuple[float, float]) -> None:
        self.state, self.system, self._times = state, state.system, times
        state.q[:] = q
        state.evaluate("motion", times[0])
        self._scale = self.system.per_velocity(1.0, self.system.size)
        term = self.system.term("motion", "J")
        self._J = np.zeros((self.system.n_c, self.system.n_u))
        np.add.at(self._J, (term.row, term.column), state.values["motion"][term.source] / self._scale[term.column])
        self._samples = self._sampled()

    def _sampled(self) -> list[np.ndarray]:
        """Return the values of the forces at times and states of a run, at one pose."""
        rng = np.random.default_rng(1)
        system, q = self.system, self.state.q.copy()
        values = []
        for part in np.linspace(0.0, 1.0, REDUNDANCY.samples):
            self.state.q[:] = q
            self.state.q[system.first_state :] += rng.uniform(-1.0, 1.0, system.n_q - system.first_state) * (part > 0)
            self.state.evaluate("motion", self._times[0] + part * (self._times[1] - self._times[0]))
            values.append(self.state.values["motion"].copy())
        self.state.q[:] = q
        return values

    def rows_of(self, joint: str) -> list[int]:
        """Return the rows of a joint's equations."""
        for group in self.system.groups:
            if joint in group.names and (count := group.record.n_equations):
                first = group.first_row + group.names.index(joint) * count
                return [*range(first, first + count)]
        return []

    def space(self, without: Iterator[int] | list[int] | tuple[int, ...]) -> np.ndarray:
        """Return an orthonormal basis of the row space of all constraints except some rows."""
        J = np.delete(self._J, list(without), axis=0)
        J = J / np.maximum(np.linalg.norm(J, axis=1, keepdims=True), np.finfo(float).tiny)
        _, values, basis = np.linalg.svd(J, full_matrices=False)
        return basis[values > REDUNDANCY.rounding * max(values, default=0.0)]

    def of(self, force: str) -> Iterator[np.ndarray]:
        """Return the directions in which time and states change a force."""
        at = 1 + TERM_SETS["motion"].index("f")
        for g, group in enumerate(self.system.groups):
            if force not in group.names or not group.entries["f"]:
                continue
            e = group.names.index(force)
            first = self.system.places["motion"][g, at] + e * group.entries["f"]
            row = np.array(group.record.patterns["f"]).reshape(group.entries["f"], -1)[:, 0]
            bodies, width = group.bodies[e], self.system.of_body.n_u
            column = bodies[row // width] * width + row % width
            moving = bodies[row // width] < len(self.system.bodies)
            samples = np.array([values[first : first + group.entries["f"]] for values in self._samples])
            samples = samples[np.isfinite(samples).all(axis=1)]  # arbitrary states may be out of a function's range
            changes = np.zeros((len(samples), self.system.n_u))
            for k, change in enumerate(samples - samples[:1]):
                np.add.at(changes[k], column[moving], change[moving])
            changes /= self._scale
            _, values, directions = np.linalg.svd(changes, full_matrices=False)
            yield from directions[values > REDUNDANCY.rounding * np.max(np.abs(samples), initial=np.finfo(float).tiny)]

    def elsewhere(self, own: np.ndarray, held: dict[int, set[int]]) -> Iterator[np.ndarray]:
        """Yield a direction, and its variants with the force moved to a body connected by a bushing."""
        yield own
        width, ground = self.system.of_body.n_u, len(self.system.bodies)
        parts = (own * self._scale).reshape(ground, width)
        acted = [*np.flatnonzero(np.abs(parts).max(axis=1) > REDUNDANCY.rounding)]
        for body in (*acted, *([ground] if len(acted) == 1 else [])):
            for other in held.get(int(body), ()):
                moved = parts.copy()
                wrench = self._wrench(parts[body], body) if body < ground else -self._wrench(parts[acted[0]], acted[0])
                if body < ground:
                    moved[body] = 0.0
                if other < ground:
                    moved[other] += self._on(wrench, other)
                if np.abs(moved).max() > REDUNDANCY.rounding:
                    yield moved.reshape(-1) / self._scale / np.linalg.norm(moved.reshape(-1) / self._scale)

    def _wrench(self, part: np.ndarray, body: int) -> np.ndarray:
        """Return the force and the torque about the origin of the ground."""
        place, turn = self._pose(body)
        force, torque = (part[:2], part[2:]) if turn is None else (part[:3], rotated(turn, part[3:]))
        return np.append(force, torque + _moment(place, force))

    def _on(self, wrench: np.ndarray, body: int) -> np.ndarray:
        place, turn = self._pose(body)
        force, torque = wrench[: len(place)], wrench[len(place) :]
        torque = torque - _moment(place, force)
        return np.append(force, torque if turn is None else rotated(turn * [1, -1, -1, -1], torque))

    def _pose(self, body: int) -> tuple[np.ndarray, np.ndarray | None]:
        """Return the position of the centre of mass, and the quaternion in space."""
        of_body = self.system.of_body
        q = self.state.q[of_body.n_q * body : of_body.n_q * (body + 1)]
        return (q[:2], None) if of_body.n_q == 3 else (q[:3], q[3:] / np.linalg.norm(q[3:]))


def _lies_in(direction: np.ndarray, basis: np.ndarray) -> bool:
    """Return True if a unit vector lies in the span of an orthonormal basis."""
    rest = direction - basis.T @ (basis @ direction)
    return bool(np.linalg.norm(rest) <= np.sqrt(REDUNDANCY.rounding))


def _moment(place: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return the moment of a force about the origin; one number in the plane."""
    moment = np.cross(np.append(place, 0.0)[:3], np.append(force, 0.0)[:3])
    return moment[len(place) % 3 :]
