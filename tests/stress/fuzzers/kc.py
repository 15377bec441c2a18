"""Compare random axles on the test rig of `stiffmbs kc` with an independent static solver."""

from __future__ import annotations

from typing import Any

import numpy as np

from stiffmbs.elements.spatial.spatial_kinds import FORCES, JOINTS
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.spatial_model import Body, Model
from stiffmbs.studies.suspension.kinematics_and_compliance import (
    AMPLITUDES,
    KinematicsAndCompliance,
    kinematics_and_compliance,
)

from ..case import Verdict, measured, told
from ..statics.assembly import Ball, ElasticBushing, End, Line, Pad, Part, Pose, Push, equilibria

WHAT = "Random five-link and wishbone axles in bump, roll and under forces: `kc` against an independent static solver."
POINTS = 5
BOUND = 1e-6
"""Allowed error relative to the size of a curve."""
G = 9.81
SIDES = {"left": 1.0, "right": -1.0}


def trial(seed: int) -> Verdict:
    """Sweep one random axle in one random load case."""
    rng = np.random.default_rng(seed)
    axle = _Axle(rng)
    case = str(
        rng.choice(
            ["bump", "roll", "lateral", "lateral_parallel", "brake", "traction", "aligning", "aligning_parallel"]
        )
    )
    size = {"bump": 30.0, "roll": 20.0, "aligning": 50.0, "aligning_parallel": 50.0}.get(case, 1.0) * float(
        rng.uniform(0.3, 1.0)
    )
    sizes: dict[str, Any] = {**dict.fromkeys(AMPLITUDES, 0.0), case: size}
    detail = f"{case} {size:.3g}, {axle.words}"
    try:
        found = kinematics_and_compliance(axle.model, "", POINTS, **sizes)
    except StiffmbsError as refusal:
        return told(f"{refusal} [{detail}]", ())
    expected = axle.expected(case, size)
    if expected is None:
        return told(f"the force balance of the check does not converge [{detail}]", ())
    error, channel = _difference(found, case, expected)
    return measured(error, BOUND, f"{channel}, {detail}")


def _difference(found: KinematicsAndCompliance, case: str, expected: dict[str, np.ndarray]) -> tuple[float, str]:
    """Return the largest difference relative to the size of its curve, 1 mm, 0.1 deg or 100 N, and its channel."""
    channels = found.sweeps[case].channels
    floors = {"toe": 0.1, "camber": 0.1, "load": 100.0}
    errors = {
        name: float(np.max(np.abs(channels[name] - curve)) / max(np.max(np.abs(curve)), floors.get(name[-4:], 1.0)))
        for name, curve in expected.items()
    }
    worst = max(errors, key=lambda name: errors[name])
    return errors[worst], worst


class _Axle:
    """Axle as a model and as parts of the static solver."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self.model = Model("Random axle", (0, 0, -G))
        self.places: dict[str, np.ndarray] = {}
        self.parts: dict[str, list[Part]] = {side: [] for side in SIDES}
        self._spindles: dict[str, End] = {}
        self._patches: dict[str, End] = {}
        kind = str(rng.choice(["rods", "elastic rods", "arm"]))
        self.words = kind
        for side, sign in SIDES.items():
            self._side(side, sign, kind)

    def _side(self, side: str, sign: float, kind: str) -> None:
        rng, upright, self._now = self._rng, f"{side}.upright", side
        mirror = np.array([1.0, sign, 1.0])
        centre = mirror * [rng.uniform(-0.1, 0.1), rng.uniform(0.6, 0.8), rng.uniform(0.28, 0.35)]
        mass = float(rng.uniform(20, 60))
        markers = {"spindle": {"point": (0.0, 0.0, 0.0)}, "patch": {"point": (0.0, 0.0, -float(centre[2]))}}
        self._body(upright, centre, mass, markers)
        self._spindles[side] = End(upright, np.zeros(3))
        self._patches[side] = End(upright, np.array([0.0, 0.0, -centre[2]]))
        low, high, toe = (mirror * each for each in ([0.0, -0.05, -0.15], [0.0, -0.08, 0.2], [0.15, -0.05, -0.05]))
        stiffness = None if kind == "rods" else float(10 ** rng.uniform(6, 7.5))
        inner = [
            centre + mirror * (np.array([x, -0.35, z]) + rng.uniform(-0.04, 0.04, 3))
            for x, z in ((0.2, -0.15), (-0.2, -0.15), (0.15, 0.15), (-0.15, 0.15), (0.15, -0.05))
        ]
        if kind == "arm":
            self._arm(side, centre, low, inner[:2], mirror)
        outer = [low, low, high, high, toe]
        for k in range(2 if kind == "arm" else 0, 5):
            self._line(f"{side}.rod{k}", End(upright, outer[k] + rng.uniform(-0.02, 0.02, 3)), inner[k], stiffness)
        seat = End(upright, mirror * (np.array([0.0, -0.1, -0.05]) + rng.uniform(-0.03, 0.03, 3)))
        tower = centre + mirror * (np.array([0.0, -0.2, 0.5]) + rng.uniform(-0.05, 0.05, 3))
        self._line(f"{side}.strut", seat, tower, float(rng.uniform(15e3, 60e3)), float(rng.uniform(1.02, 1.1)))

    def _body(self, name: str, place: np.ndarray, mass: float, markers: dict[str, Any] | None = None) -> None:
        inertia = (0.01 * mass, 0.015 * mass, 0.01 * mass)
        self.model.add(name, Body(mass=mass, inertia=inertia, position=tuple(place.tolist()), markers=markers or {}))
        self.places[name] = place
        self.parts[self._now].append(Push(End(name, np.zeros(3)), np.array([0.0, 0.0, -mass * G]), constant=True))

    def _arm(self, side: str, centre: np.ndarray, low: np.ndarray, inner: list[np.ndarray], mirror: np.ndarray) -> None:
        """Add a lower wishbone on two bushings, with a ball joint at the upright."""
        rng, name = self._rng, f"{side}.arm"
        place = centre + low - mirror * [0.0, 0.15, 0.0]
        self._body(name, place, float(rng.uniform(3, 8)))
        there = End(f"{side}.upright", low)
        self.model.add(
            f"{side}.ball", JOINTS["spherical"](i=_marker(there), j=_marker(End(name, centre + low - place)))
        )
        self.parts[self._now].append(Ball(there, End(name, centre + low - place)))
        for k, point in enumerate(inner):
            values = np.concatenate([10 ** rng.uniform(5.5, 7, 3), 10 ** rng.uniform(0, 2, 3)])
            ends = End(name, point - place), End("ground", point)
            fields = {"i": _marker(ends[0]), "j": _marker(ends[1]), "stiffness": tuple(values.tolist())}
            self.model.add(f"{side}.bush{k}", FORCES["bushing"](**fields))
            self.parts[self._now].append(ElasticBushing(*ends, values))

    def _line(self, name: str, end: End, to: np.ndarray, stiffness: float | None, preload: float = 1.0) -> None:
        length = float(np.linalg.norm(self.places[end.body] + end.point - to))
        there = End("ground", to)
        if stiffness is None:
            self.model.add(name, JOINTS["distance"](i=_marker(end), j=_marker(there), length=length))
            self.parts[self._now].append(Line(end, there, length, None, 1))
            return
        spring = {"stiffness": stiffness, "free_length": length * preload}
        self.model.add(name, FORCES["spring_damper"](i=_marker(end), j=_marker(there), **spring))
        self.parts[self._now].append(Line(end, there, length * preload, stiffness))

    def expected(self, case: str, size: float) -> dict[str, np.ndarray] | None:
        """Return the curves of both wheels from minus to plus a size, or None if no equilibrium is found."""
        curves: dict[str, np.ndarray] = {}
        for side, sign in SIDES.items():
            parts = [*self.parts[side], *self._rig(side, sign, case, size)]
            places = {name: place for name, place in self.places.items() if name.startswith(side)}
            up = equilibria(places, parts, np.linspace(0, 1, 1 + POINTS // 2))
            down = equilibria(places, parts, np.linspace(0, -1, 1 + POINTS // 2))
            if up is None or down is None:
                return None
            rest = up[0][0][f"{side}.upright"]
            points = [
                self._measures(side, sign, poses[f"{side}.upright"], rest, float(multipliers[-1]))
                for poses, multipliers in (*down[:0:-1], *up)
            ]
            curves |= {f"{side}.{name}": np.array([point[name] for point in points]) for name in points[0]}
        return curves

    def _rig(self, side: str, sign: float, case: str, size: float) -> list[Part]:
        """Return the force of a load case on one side, and the pad."""
        force, torque, at = np.zeros(3), np.zeros(3), self._patches[side]
        lift = {"bump": 1.0, "roll": sign}.get(case, 0.0) * 1e-3 * size
        if case == "lateral":
            force[1] = sign * 1e3 * size
        elif case == "lateral_parallel":
            force[1] = 1e3 * size
        elif case == "brake":
            force[0] = -1e3 * size
        elif case == "traction":
            force[0], at = 1e3 * size, self._spindles[side]
        elif case == "aligning":
            torque[2] = -sign * size
        elif case == "aligning_parallel":
            torque[2] = size
        return [Push(at, force, torque), self._pad(side, lift)]

    def _pad(self, side: str, lift: float = 0.0) -> Pad:
        return Pad(self._spindles[side], -float(self._patches[side].point[2]), 0.0, lift)

    def _measures(self, side: str, sign: float, upright: Pose, rest: Pose, load: float) -> dict[str, float]:
        along, pad = upright.rotation[:, 1], self._pad(side)
        moved, centre = pad.contact(upright) - pad.contact(rest), upright.position - rest.position
        return {
            "travel": 1e3 * centre[2],
            "toe": float(np.degrees(sign * np.arctan2(along[0], along[1]))),
            "camber": float(np.degrees(-sign * np.arcsin(along[2]))),
            "lateral": 1e3 * sign * moved[1],
            "longitudinal": 1e3 * centre[0],
            "load": load,
        }


def _marker(end: End) -> dict[str, Any]:
    return {"body": end.body, "point": end.point.tolist()}
