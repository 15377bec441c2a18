"""What formulas may call a body's coordinates, and the measures between markers: in the plane, and in space."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .formula import Formula


@dataclass(frozen=True)
class FormulaNames:
    """The names of one family of models.

    Attributes
    ----------
    family : str
        ``the plane`` or ``space``, for sentences.
    positions, velocities : tuples of str
        Of a body: ``cart.x``, ``cart.vx``.
    position_measures, velocity_measures : tuples of str
        Between two markers: ``dx(bar.end, ground)``.
    along_axes : tuple of str
        The measures that may have a third marker, whose axes they are taken along.
    """

    family: str
    positions: tuple[str, ...]
    velocities: tuple[str, ...]
    position_measures: tuple[str, ...]
    velocity_measures: tuple[str, ...]
    along_axes: tuple[str, ...]

    def validation_errors(self, formula: Formula) -> Iterator[str]:
        """Why a formula has no meaning in the family: names of the other one, velocities where positions are wanted."""
        of_body = self.positions + (self.velocities if formula.velocities else ())
        for body, coordinate in formula.coordinates():
            if coordinate not in of_body:
                yield f"found '{body}.{coordinate}', expected one of {body}.{f', {body}.'.join(of_body)}"
        for name, joint in formula.reactions():
            if self is PLANE and name not in IN_THE_PLANE:
                yield f"found '{name}({joint})' in '{formula.text}', expected one of {', '.join(IN_THE_PLANE)}"
        for name, markers in formula.measures():
            if name not in (*self.position_measures, *self.velocity_measures):
                known = dict.fromkeys((*self.position_measures, *self.velocity_measures))
                yield f"found the measure {name} in '{formula.text}', expected one of {self.family}: {', '.join(known)}"
            elif name not in self.position_measures and not formula.velocities:
                yield f"found the velocity {name} in '{formula.text}', expected positions only"
            elif len(markers) > 2 and name not in self.along_axes:
                yield f"found {len(markers)} markers of {name} in '{formula.text}', expected one or two"


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
"""By the dimensions of the model."""
REACTIONS = ("fx", "fy", "fz", "tx", "ty", "tz")
"""Components of what a joint does to its first body, along ground axes: ``fy(guide)``; of both families."""
IN_THE_PLANE = ("fx", "fy", "tz")
"""Those of a joint in the plane."""
COORDINATES = frozenset(name for names in NAMES.values() for name in (*names.positions, *names.velocities))
"""Of bodies, in both families."""
VELOCITIES = tuple(
    dict.fromkeys(name for names in NAMES.values() for name in (*names.velocities, *names.velocity_measures))
)
"""Of both families, of bodies and between markers."""
MEASURES = tuple(
    dict.fromkeys(
        name for names in NAMES.values() for name in (*names.position_measures, *names.velocity_measures)
    )
)  # fmt: skip
"""Of both families: what a formula calls by such a name is a measure."""
