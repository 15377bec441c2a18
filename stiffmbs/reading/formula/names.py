"""Names of body coordinates and of measures between markers, in planar and spatial models."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..did_you_mean import did_you_mean
from ..joint_name import ORDERS, joint_channels

if TYPE_CHECKING:
    from ...elements.element import Joint
    from .formula import Formula


@dataclass(frozen=True)
class FormulaNames:
    """Names of one family of models."""

    family: str  # ``the plane`` or ``space``, for messages
    # positions, velocities: coordinates and velocities of a body: ``cart.x``, ``cart.vx``
    positions: tuple[str, ...]
    velocities: tuple[str, ...]
    # position_measures, velocity_measures: measures between two markers: ``dx(bar.end, ground)``
    position_measures: tuple[str, ...]
    velocity_measures: tuple[str, ...]
    along_axes: tuple[str, ...]  # measures that accept a third marker, along whose axes they are resolved

    def validation_errors(self, formula: Formula, joints: Mapping[str, Joint]) -> Iterator[str]:
        """Yield faults of a formula: names of the other family, and velocities in formulas of positions."""
        of_body = self.positions + (self.velocities if formula.velocities else ())
        for body, coordinate in formula.coordinates():
            if body in joints:
                yield from self._of_joint(formula, body, joints[body], coordinate)
            elif coordinate not in of_body:
                near = did_you_mean(coordinate, of_body)
                yield f"found '{body}.{coordinate}'{near}, expected one of {body}.{f', {body}.'.join(of_body)}"
        for name, joint in formula.reactions():
            if self is PLANE and name not in IN_THE_PLANE:
                yield f"found '{name}({joint})' in '{formula.text}', expected one of {', '.join(IN_THE_PLANE)}"
        for name, markers in formula.measures():
            if name not in (*self.position_measures, *self.velocity_measures):
                known = dict.fromkeys((*self.position_measures, *self.velocity_measures))
                near = did_you_mean(name, known)
                yield f"found the measure {name}{near} in '{formula.text}', expected one of {self.family}: {', '.join(known)}"
            elif name not in self.position_measures and not formula.velocities:
                yield f"found the velocity {name} in '{formula.text}', expected positions only"
            elif len(markers) > 2 and name not in self.along_axes:
                yield f"found {len(markers)} markers of {name} in '{formula.text}', expected one or two"

    def _of_joint(self, formula: Formula, name: str, joint: Joint, channel: str) -> Iterator[str]:
        """Yield the reason why a name is not that of a joint's coordinate, or of its rate where velocities are permitted."""
        known = joint_channels(joint.free_coordinates(), ORDERS[: 1 + formula.velocities])
        if channel in known:
            return
        found = f"found '{name}.{channel}'{did_you_mean(channel, known)} in '{formula.text}'"
        if not known:
            yield f"{found}, a joint of the type {joint.kind}, which has no coordinates, expected a measure between its markers"
        elif channel in joint_channels(joint.free_coordinates()):
            order = "velocity" if channel.endswith("_rate") else "acceleration"
            yield f"{found}, which is a{'n' * (order[0] == 'a')} {order}, expected one of {name}.{f', {name}.'.join(known)}"
        else:
            yield f"{found}, expected one of {name}.{f', {name}.'.join(known)}"


PLANE = FormulaNames(
    family="the plane",
    positions=("x", "y", "angle"),
    velocities=("vx", "vy", "omega"),
    position_measures=("dx", "dy", "dm", "az"),
    velocity_measures=("vx", "vy", "vm", "vr", "wz"),
    along_axes=("dx", "dy", "vx", "vy"),
)
SPACE = FormulaNames(
    family="space",
    positions=("x", "y", "z", "q0", "q1", "q2", "q3"),
    velocities=("vx", "vy", "vz", "wx", "wy", "wz"),
    position_measures=("dx", "dy", "dz", "dm", "ax", "ay", "az"),
    velocity_measures=("vx", "vy", "vz", "vm", "vr", "wx", "wy", "wz", "wm"),
    along_axes=("dx", "dy", "dz", "vx", "vy", "vz", "wx", "wy", "wz"),
)
NAMES = {2: PLANE, 3: SPACE}
"""Names by the dimension of the model."""
REACTIONS = ("fx", "fy", "fz", "tx", "ty", "tz")
"""Components of a joint's reaction on its first body, along ground axes: ``fy(guide)``; in both families."""
IN_THE_PLANE = ("fx", "fy", "tz")
"""Components of a reaction in the plane."""
COORDINATES = frozenset(name for names in NAMES.values() for name in (*names.positions, *names.velocities))
"""Coordinates and velocities of bodies in both families."""
VELOCITIES = tuple(
    dict.fromkeys(name for names in NAMES.values() for name in (*names.velocities, *names.velocity_measures))
)
"""Velocities of bodies and between markers in both families."""
MEASURES = tuple(
    dict.fromkeys(
        name for names in NAMES.values() for name in (*names.position_measures, *names.velocity_measures)
    )
)  # fmt: skip
"""Measures of both families; a call of such a name is a measure."""
