"""Joint friction as formula forces and torques.  MSC Adams/Solver, FRICTION statement.

The normal force follows from the joint reaction. The friction coefficient is a STEP5 function of the sliding speed: it
rises from zero to the static coefficient at the stiction velocity, then falls to the dynamic coefficient. Joints slide slowly
below the stiction velocity; Adams' MAX_STICTION_DEFORMATION has no counterpart.
"""

from __future__ import annotations

from collections.abc import Iterator

from ...elements.forces.friction import AT_REST
from ...elements.loads import TINY
from ..functions.translate import Translation
from ..statements.constraints import TRANSLATIONAL, Joint
from ..statements.friction import JointFriction
from ..statements.text import of_each
from .forces import TORQUE
from .mechanism import Mechanism, Place
from .relations import initial_displacement

AXES = "XYZ"


def frictions(translation: Translation) -> dict[str, object]:
    """Return the friction forces and torques by name, except those of deactivated joints."""
    return of_each(_acting(translation.mechanism), lambda friction: _FrictionLaw(friction, translation).made())


def notes(mechanism: Mechanism) -> Iterator[str]:
    """Yield one sentence for each difference from Adams' friction."""
    labels = ", ".join(friction.label for friction in _acting(mechanism))
    if labels:
        yield (
            f"{labels}: below STICTION_TRANSITION_VELOCITY the joint slides slowly; Adams holds it within "
            "MAX_STICTION_DEFORMATION"
        )
    crosses = ", ".join(
        friction.label
        for friction in _acting(mechanism)
        if friction.yokes == "IJ" and mechanism.dataset.joints[friction.joint].kind in ARMS
    )
    if crosses:
        yield f"{crosses}: friction acts on both arms of the cross, as no YOKE is given"


def _acting(mechanism: Mechanism) -> list[JointFriction]:
    dataset = mechanism.dataset
    return [friction for friction in dataset.frictions.values() if ("JOINT", friction.joint) not in dataset.inactive]


def _joint(friction: JointFriction, mechanism: Mechanism) -> Joint:
    joint = mechanism.dataset.joints.get(friction.joint)
    if joint is None:
        raise friction.fault(f"found JOINT = {friction.joint}, expected the number of a JOINT")
    if joint.kind not in _KINDS:
        raise friction.fault(f"found friction of {joint.label}, {joint.kind}, expected a joint of {', '.join(_KINDS)}")
    return joint


_KINDS = ("REVOLUTE", "TRANSLATIONAL", "CYLINDRICAL", "SPHERICAL", "UNIVERSAL", "HOOKE")
ARMS = {"UNIVERSAL": "ZZ", "HOOKE": "XY"}
"""Axes of markers I and J along the arms of a universal joint's cross."""


class _FrictionLaw:
    """Friction law of one joint as Adams function expressions."""

    def __init__(self, friction: JointFriction, translation: Translation) -> None:
        self._f, self._translation, self._joint = friction, translation, _joint(friction, translation.mechanism)
        i, j = self._places = translation.mechanism.ends(self._joint)
        self._ends = {"i": i.reference, "j": j.body}

    def made(self) -> dict[str, object]:
        """Return the elements of the scene."""
        makers = {
            "REVOLUTE": self._pin, "TRANSLATIONAL": self._guide, "CYLINDRICAL": self._sleeve, "SPHERICAL": self._ball,
        }  # fmt: skip
        return makers.get(self._joint.kind, self._cross)()

    def _pin(self) -> dict[str, object]:
        return self._torque([None, None, self._about("Z", self._joint.j)], self._f.name)

    def _cross(self) -> dict[str, object]:
        """Return the torque of each arm as a pin, between the two parts: the mass of the cross is ignored."""
        found: dict[str, object] = {}
        ends = zip(("I", "J"), ARMS[self._joint.kind], (self._joint.i, self._joint.j), self._places, strict=True)
        for end, arm, marker, place in ends:
            if end in self._f.yokes:
                laws = [self._about(arm, marker) if axis == arm else None for axis in AXES]
                found |= self._torque(laws, self._f.name + (TORQUE if found else ""), place)
        return found

    def _about(self, axis: str, marker: int) -> str:
        """Return the friction torque of a pin along an axis of a marker."""
        f = self._f
        load = self._sum(
            (
                "REACTION_FORCE",
                f"{f.pin!r}*{self._across('F', axis, marker)} + {f.collar!r}*ABS({self._part('F', axis, marker)})",
            ),
            ("BENDING_MOMENT", f"{f.pin / f.bending_arm!r}*{self._across('T', axis, marker)}"),
        )
        speed = f"{f.pin!r}*{self._turning(axis, marker)}"
        return f"-({self._coefficient(speed)})*({load}) - {self._preload(f.torque)}*({self._direction(speed)})"

    def _guide(self) -> dict[str, object]:
        f, speed = self._f, self._sliding
        load = self._sum(
            ("REACTION_FORCE", self._across("F")),
            ("BENDING_MOMENT", f"{self._across('T')}/{self._overlap()}"),
            ("TORSIONAL_MOMENT", f"ABS({self._part('T', 'Z')})/{f.torsion_arm!r}"),
        )
        law = f"-({self._coefficient(speed)})*({load}) - {self._preload(f.force)}*({self._direction(speed)})"
        return self._force([None, None, law], f.name)

    def _sleeve(self) -> dict[str, object]:
        f, along, about = self._f, self._sliding, f"({self._f.pin!r}*{self._turning('Z')})"
        speed = self._speed(along, about)
        load = self._sum(
            ("REACTION_FORCE", self._across("F")), ("BENDING_MOMENT", f"{self._across('T')}/{self._overlap()}")
        )
        mu, direction = self._of_magnitude(speed), self._direction(speed)
        force = f"-(({mu})*({load}) + {self._preload(f.force)}*({direction}))*{along}/{speed}"
        torque = f"-({f.pin!r}*({mu})*({load}) + {self._preload(f.torque)}*({direction}))*{about}/{speed}"
        return self._force([None, None, force], f.name) | self._torque([None, None, torque], f.name + TORQUE)

    def _ball(self) -> dict[str, object]:
        f = self._f
        parts = [f"({f.ball!r}*{self._turning(axis)})" for axis in AXES]
        speed = self._speed(*parts)
        load = self._sum(("REACTION_FORCE", f"{f.ball!r}*{self._root('F', AXES, self._joint.j)}"))
        size = (
            f"(({self._of_magnitude(speed)})*({load}) + {self._preload(f.torque)}*({self._direction(speed)}))/{speed}"
        )
        return self._torque([f"-{part}*{size}" for part in parts], f.name)

    def _sum(self, *loads: tuple[str, str]) -> str:
        return " + ".join(text for name, text in loads if name in self._f.inputs) or "0"

    def _preload(self, size: float) -> str:
        return repr(size if "PRELOAD" in self._f.inputs else 0.0)

    def _coefficient(self, speed: str) -> str:
        """Return mu as a function of a signed speed."""
        return self._of_magnitude(speed) + self._fallen(f"-({speed})", "+")

    def _of_magnitude(self, speed: str) -> str:
        """Return mu as a function of a non-negative speed."""
        f, slow = self._f, self._f.stiction_velocity
        return f"STEP5({speed}, {-slow!r}, {-f.static!r}, {slow!r}, {f.static!r})" + self._fallen(speed, "-")

    def _fallen(self, speed: str, sign: str) -> str:
        """Return the drop from the static to the dynamic coefficient with increasing speed."""
        f = self._f
        less = f.static - f.dynamic
        return f" {sign} STEP5({speed}, {f.stiction_velocity!r}, 0, {f.friction_velocity!r}, {less!r})" if less else ""

    def _direction(self, speed: str) -> str:
        slow = self._f.stiction_velocity
        return f"STEP5({speed}, {-slow!r}, -1, {slow!r}, 1)"

    def _speed(self, *parts: str) -> str:
        squares = " + ".join(f"{part}**2" for part in parts)
        return f"SQRT({squares} + {(AT_REST * self._f.stiction_velocity) ** 2!r})"

    def _overlap(self) -> str:
        f = self._f
        if not f.growth:
            return repr(f.overlap)
        first = initial_displacement(TRANSLATIONAL, *self._places) / self._translation.units.length
        direction = f"(DZ({self._joint.i},{self._joint.j},{self._joint.j}) - ({first!r}))"
        return f"({f.overlap!r} {'+' if f.growth > 0 else '-'} {direction})"

    def _turning(self, axis: str, along: int | None = None) -> str:
        i, j = self._joint.i, self._joint.j
        return f"W{axis}({i},{j},{along or j})"

    @property
    def _sliding(self) -> str:
        i, j = self._joint.i, self._joint.j
        return f"VZ({i},{j},{j},{j})"

    def _part(self, letter: str, axis: str, along: int | None = None) -> str:
        component = 4 * (letter == "T") + "MXYZ".index(axis) + 1
        return f"JOINT({self._joint.ident},0,{component},{along or self._joint.j})"

    def _across(self, letter: str, axis: str = "Z", along: int | None = None) -> str:
        """Return the load normal to an axis of a marker (default J)."""
        return self._root(letter, AXES.replace(axis, ""), along or self._joint.j)

    def _root(self, letter: str, axes: str, along: int) -> str:
        tiny = TINY / self._translation.force_unit(letter) ** 2
        return f"SQRT({' + '.join(f'{self._part(letter, axis, along)}**2' for axis in axes)} + {tiny!r})"

    def _force(self, laws: list[str | None], name: str) -> dict[str, object]:
        return {name: self._element("force", laws, self._places[1])}

    def _torque(self, laws: list[str | None], name: str, place: Place | None = None) -> dict[str, object]:
        return {name: self._element("torque", laws, place or self._places[1])}

    def _element(self, kind: str, laws: list[str | None], place: Place) -> dict[str, object]:
        arm = int(kind == "torque")
        formulas = [0 if law is None else self._translation.law(law, self._f, arm=arm) for law in laws]
        return {"type": kind, **self._ends, "frame": place.reference, kind: formulas}
