"""Full revolutions of the joint angles of spatial models.

A pose defines such an angle up to full turns. They are counted by the integration where an element or a request names
the angle, and otherwise follow from its rate and acceleration at the output times.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import OutputRows
from ..dynamics.turns import counted_angles
from ..elements.element import Joint
from ..elements.turns import INITIAL_COUNT, TURN
from ..notes import Note, NoteKind
from ..reading.joint_name import ORDERS

UNCERTAIN_TURN = 1.0
"""Difference of an angle's change between output times and that predicted from its rates, rad, from which on the number
of turns is uncertain. The same limit holds for the part of the prediction that follows from accelerations: changes are
known up to full turns, so that a prediction over too long an interval may agree by chance."""


UNCERTAIN = NoteKind(
    "uncertain-joint-angle",
    "the revolutions of {element}{more} are uncertain: between t = {begin:.6g} s and {end:.6g} s the angle changes too "
    "much for the output times",
    "name it in a request, so that the integration counts its revolutions, or use more output points",
)


@dataclass(frozen=True)
class JointAngles:
    """Angles of the joints of a spatial model within a turn, and the counters of their turns.

    `places`: places of each angle, its rate and its acceleration in the values of the output terms, by channel.
    `counters`: coordinate that counts the turns of some angles, by channel. `start`: known angles at the first instant,
    by channel; others begin in the turn around zero.
    """

    places: Mapping[str, tuple[int, ...]]
    counters: Mapping[str, int]
    start: Mapping[str, float]

    def continuous(self, rows: OutputRows) -> dict[str, np.ndarray]:
        """Return the angles with their full revolutions by channel, shape (n,), rad."""
        found = {}
        for name, places in self.places.items():
            if name in self.counters:
                angle = rows.values[:, places[0]]
                found[name] = angle + TURN * np.round((rows.q[:, self.counters[name]] - angle) / TURN)
        if self.followed:
            change, by_rates, by_accelerations = self._changes(rows)
            angles = rows.values[:, [self.places[name][0] for name in self.followed]]
            known = np.array([self.start.get(name, INITIAL_COUNT) for name in self.followed])
            angles += TURN * np.round((known - angles[0]) / TURN)
            angles[1:] += TURN * np.cumsum(np.round((by_rates + by_accelerations - change) / TURN), axis=0)
            found |= dict(zip(self.followed, angles.T, strict=True))
        return found

    def uncertain(self, rows: OutputRows) -> Iterator[Note]:
        """Yield a note on the angles whose turns between output times are uncertain, the least certain first."""
        if not self.followed or len(rows.t) < 2:
            return
        change, by_rates, by_accelerations = self._changes(rows)
        apart = np.abs(np.remainder(by_rates + by_accelerations - change + np.pi, TURN) - np.pi)
        apart = np.nan_to_num(np.maximum(apart, np.abs(by_accelerations)))
        row, k = np.unravel_index(int(np.argmax(apart)), apart.shape)
        if apart[row, k] > UNCERTAIN_TURN:
            others = int(np.count_nonzero(np.any(apart > UNCERTAIN_TURN, axis=0))) - 1
            more = f" and of {others} other angle{'s' * (others > 1)}" if others else ""
            yield UNCERTAIN(self.followed[k], more=more, begin=rows.t[row], end=rows.t[row + 1])

    @cached_property
    def followed(self) -> list[str]:
        """Angles without a counter."""
        return [name for name in self.places if name not in self.counters]

    def _changes(self, rows: OutputRows) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the changes of angles between instants, and the parts by rates and accelerations of the Hermite polynomial.

        Shape (n - 1, angles).
        """
        angle, rate, acceleration = (
            rows.values[:, [self.places[name][order] for name in self.followed]] for order in range(len(ORDERS))
        )
        h = np.diff(rows.t)[:, None]
        return np.diff(angle, axis=0), h / 2 * (rate[:-1] + rate[1:]), -(h**2) / 12 * np.diff(acceleration, axis=0)


def joint_angles(system: System) -> JointAngles | None:
    """Return the angles of a system's joints; None in the plane, where bodies' angles count their turns, or without any."""
    if system.of_body.dimensions == 2:
        return None
    angles = {
        f"{name}.{coordinate}": tuple(system.reported[f"{name}.{coordinate}{order}"] for order in ORDERS)
        for group in system.groups
        if issubclass(group.kind.element, Joint) and not group.record.n_counters
        for coordinate in group.kind.element.free_coordinates()
        if coordinate.startswith("angle")
        for name in group.names
    }
    places = {name: found for name, found in angles.items() if min(found) >= 0}
    # an element may read another turn than that of the joint, which its drive selects and requests follow
    counted = sorted(counted_angles(system), key=lambda angle: (angle.driven, angle.element == angle.channel))
    counters = {angle.channel: angle.place for angle in counted if angle.channel}
    start = {**system.described_angles, **system.start_angles}
    return JointAngles(places, counters, start) if places else None
