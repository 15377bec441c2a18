"""Coordinates of all joints and their rates at one state, as arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ..compile.machine.layout import address, packed
from ..compile.machine.object_code import SHORT
from ..compile.machine.routines import Routine
from ..compile.state import State
from ..compile.system import System
from ..dynamics.native.layouts import FOLLOWED, JOINT_COORDINATES, WITHOUT_TURNS
from ..elements.element import Joint
from ..elements.turns import INITIAL_COUNT
from .joint_angles import joint_angles

FOLLOW = Routine(
    "stiffmbs.dynamics.native.joint_coordinates", "follow", "void(float64, float64*, float64*, int64*)", level=SHORT
)


class JointCoordinates:
    """Coordinates of joints and their rates, in the order of the joints; angles with their full turns.

    Turns that the integration does not count follow from the mean of the rates at the last state and now. The change of
    an angle may differ from that by up to half a turn.

    - `names`: channels of the coordinates. `coordinates`, `rates`: their values, m or rad, and rates, at the last state.
    - `angles`: channels among these whose turns are counted, by the integration or here.
    - `any_followed`: true if some angles must be followed at the end of each step.
    - `table`: addresses for compiled code (`stiffmbs.dynamics.native.layouts.JOINT_COORDINATES`).
    """

    def __init__(self, system: System, joints: Iterable[str]) -> None:
        angles, at = joint_angles(system), system.reported
        turning = set(angles.places) if angles else set()
        counters = angles.counters if angles else {}
        self._start = dict(angles.start) if angles else {}
        of_joint = {
            name: [f"{name}.{coordinate}" for coordinate in group.kind.element.free_coordinates()]
            for group in system.groups
            if issubclass(group.kind.element, Joint)
            for name in group.names
        }
        named = (name for joint in joints for name in of_joint.get(joint, ()))
        self.names = tuple(name for name in named if min(at[name], at[f"{name}_rate"]) >= 0)
        self.angles = tuple(name for name in self.names if name in turning)
        count = len(self.names)
        self.coordinates, self.rates = np.zeros(count), np.zeros(count)
        counter = [counters.get(name, FOLLOWED) if name in turning else WITHOUT_TURNS for name in self.names]
        self.any_followed = FOLLOWED in counter
        self._state = State(system)
        self._state.load("output")
        used = np.array([any(name in of_joint for name in group.names) for group in system.groups], dtype=bool)
        self._arrays = {
            "state": self._state.restricted({"output": used}),
            "place": np.array([at[name] for name in self.names], dtype=np.int64),
            "rate_place": np.array([at[f"{name}_rate"] for name in self.names], dtype=np.int64),
            "counter": np.array(counter, dtype=np.int64),
            "coordinate": self.coordinates,
            "rate": self.rates,
        }
        self.table = packed(JOINT_COORDINATES, {"n": count, **self._arrays})
        self._cells, self._at = self.table.view(JOINT_COORDINATES.cells)[0], address(self.table)
        self._follow = FOLLOW.short_call

    def watch(self, q: np.ndarray, u: np.ndarray) -> None:
        """Read states from this memory from now on."""
        self._read, self._memory = (q, u), (address(q), address(u))  # kept alive, and where it is

    def begin(self, t: float, known: Mapping[str, float]) -> None:
        """Compute all values at a time, s; `known`: angles in their turns, by channel, in place of those of the start."""
        for k, name in enumerate(self.names):
            self.coordinates[k] = known.get(name, self._start.get(name, INITIAL_COUNT))
        self._cells["t"] = t
        self.follow(t)

    def continue_from(self, t: float, coordinates: np.ndarray, rates: np.ndarray) -> None:
        """Take all values at a time, s, as they are."""
        self.coordinates[:], self.rates[:] = coordinates, rates
        self._cells["t"] = t

    def follow(self, t: float) -> None:
        """Compute all values at the watched state and a later time, s."""
        self._follow(t, *self._memory, self._at)
