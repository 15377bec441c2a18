"""Random mechanisms as in `adams_random` with what hangs on reactions: FRICTION, JOINT() in a force; and PTCV, PINPUT, SENSOR.

Loads that hang on reactions are found by iteration: the reactions of an instant give loads, these give reactions, until both agree.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .adams_oracle import Marker, Mechanism
from .adams_random import KINDS, Trial

RUBBING = ("REVOLUTE", "TRANSLATIONAL", "CYLINDRICAL", "SPHERICAL")
HALF = 2.0
"""Of the way from the first to the last point of a wire, m."""


@dataclass(frozen=True)
class PressedMechanism(Mechanism):
    """A mechanism with forces that are functions of a view and of what joints do to parts at that instant."""

    pressed: list = field(default_factory=list)

    def solve(self, t, y):
        found = super().solve(t, y)
        for _ in range(200):
            pulls = found[2]
            acting = [lambda view, act=act, pulls=pulls: act(view, pulls) for act in self.pressed]
            again = Mechanism(self.parts, self.joints, [*self.forces, *acting], self.gravity).solve(t, y)
            change = max((np.abs(again[2][name] - pulls[name]).max() for name in pulls), default=0.0)
            found = again
            if change < 1e-11 * (1 + max(np.abs(pull).max() for pull in pulls.values())):
                return found
        raise ArithmeticError("loads and reactions do not agree")


def pulled(view, pulls, joint, marker: Marker):
    """Force on the part of a marker by a joint, and torque about the marker, in ground axes."""
    at, k = view.point(marker).value, marker.part
    force, torque = pulls[joint]
    if k < 0:
        return -force.sum(0), -(torque + np.cross(view.r - at, force)).sum(0)
    return force[k], torque[k] + np.cross(view.r[k] - at, force[k])


def step5(x, x0, h0, x1, h1):
    z = np.clip((x - x0) / (x1 - x0), 0, 1)
    return h0 + (h1 - h0) * z**3 * (10 + z * (6 * z - 15))


def rising(v, slow):
    return step5(v, -slow, -1, slow, 1)


def mu(v, static, dynamic, slow, fast):
    if abs(v) < slow:
        return static * rising(v, slow)
    return np.sign(v) * step5(abs(v), slow, static, fast, dynamic)


class Statements(Trial):
    """A trial with the newer statements."""

    def __post_init__(self):
        super().__post_init__()
        self.pressed = []

    def mechanism(self):
        self.text()  # sets gravity
        plain = super().mechanism()
        return PressedMechanism(plain.parts, plain.joints, plain.forces, plain.gravity, self.pressed)

    def bead(self, on):
        """A further part, a point of which stays on a wire of another one that is bent in space."""
        rng, number = self.rng, len(self.bodies) + 1
        place, seat = rng.uniform(-0.6, 0.6, 3), self.turn()
        bends = [
            np.polynomial.Polynomial([-(HALF**2), 0, 1]) * np.polynomial.Polynomial(rng.uniform(-0.1, 0.1, 2))
            for _ in "yz"
        ]
        wire = [np.polynomial.Polynomial([0, 1]), *bends]
        u = rng.uniform(-0.5, 0.5)
        at = place + seat @ [own(u) for own in wire]
        base, _ = self.moving(on, at)
        spin = rng.uniform(-2, 2, 3)
        velocity = base + rng.uniform(-1, 1) * seat @ [own.deriv()(u) for own in wire]
        center = at + rng.uniform(-0.4, 0.4, 3)
        k = len(self.bodies)
        self.bodies.append(self.random_part(center, velocity + np.cross(spin, center - at), spin))
        self.written_part(k)
        i, rm = self.marker(k, at, self.turn()), self.marker(on, place, seat)
        points = np.array([[own(x) for own in wire] for x in np.linspace(-HALF, HALF, 7)])
        self.statement(f"MATRIX/{number}", "FULL = RORDER", "M = 7", "N = 3", "VALUES = " + "\n, ".join(
            self.numbers(row, self.length) for row in points))  # fmt: skip
        self.statement(f"CURVE/{number}", "OPEN", "CURVE_POINTS", "ORDER = 4", f"MATRIX = {number}")
        self.statement(f"MARKER/{800 + number}", f"PART = {on + 2}", "FLOATING")
        self.statement(f"PTCV/{number}", f"CURVE = {number}", f"I = {i}", f"JFLOAT = {800 + number}", f"RM = {rm}")
        I, R = self.markers[i], self.markers[rm]

        def on_wire(view):
            gap = view.point(I) - view.point(R)
            x, *others = (gap @ view.axis(R, name) for name in "xyz")
            return np.vstack([
                other.second - own.deriv()(x.value) * x.second - own.deriv(2)(x.value) * x.rate**2
                for own, other in zip(bends, others, strict=True)
            ])  # fmt: skip

        self.equations[f"PTCV_{number}"] = on_wire
        self.reactions[f"PTCV_{number}"] = I

    def rub(self, kind, number, i, j):
        """FRICTION of a joint."""
        rng, joint = self.rng, f"JOINT_{number}"
        I, J = self.markers[i], self.markers[j]
        static = rng.uniform(0.05, 0.25)
        dynamic, slow, times = static * rng.uniform(0.5, 0.9), rng.uniform(0.1, 0.5), rng.uniform(1.3, 3)
        pin, collar, bending, twisting, overlap = rng.uniform(0.02, 0.1, 5) * [1, 1, 6, 6, 10]
        force, torque = rng.uniform(0, 0.5, 2) * [1, 0.2]
        pressing = rng.random(4) < 0.7
        names = [
            name
            for name, yes in zip(
                ("PRELOAD", "REACTION_FORCE", "BENDING_MOMENT", "TORSIONAL_MOMENT"), pressing, strict=True
            )
            if yes
        ]
        x, f = self.length, self.force
        self.statement(
            f"FRICTION/{number}", f"JOINT = {number}", f"MU_STATIC = {static:.16g}", f"MU_DYNAMIC = {dynamic:.16g}",
            f"STICTION_TRANSITION_VELOCITY = {slow / x:.16g}", f"TRANSITION_VELOCITY_COEFFICIENT = {times:.16g}",
            f"PIN_RADIUS = {pin / x:.16g}", f"BALL_RADIUS = {pin / x:.16g}", f"FRICTION_ARM = {collar / x:.16g}",
            f"BENDING_REACTION_ARM = {bending / x:.16g}", f"REACTION_ARM = {twisting / x:.16g}",
            f"INITIAL_OVERLAP = {overlap / x:.16g}", f"FRICTION_FORCE_PRELOAD = {force / f:.16g}",
            f"FRICTION_TORQUE_PRELOAD = {torque / (f * x):.16g}", "INPUTS = " + (":".join(names) or "NONE"),
        )  # fmt: skip
        preload, by_force, by_bending, by_twist = pressing

        def act(view, pulls):
            axes, at = view.axes(J), view.point(I).value
            F, M = (axes.T @ part for part in pulled(view, pulls, joint, I))
            gap = view.point(I) - view.point(J)
            w = axes.T @ (view.spin(I).rate - view.spin(J).rate)
            along = (gap @ view.axis(J, "z")).rate
            across, moment = np.hypot(*F[:2]), np.hypot(*M[:2])

            def braked(v, load, held):
                return -mu(v, static, dynamic, slow, slow * times) * load - preload * held * rising(v, slow)

            push, turn = np.zeros(3), np.zeros(3)
            if kind == "REVOLUTE":
                load = by_force * (pin * across + collar * abs(F[2])) + by_bending * pin / bending * moment
                turn[2] = braked(pin * w[2], load, torque)
            elif kind == "TRANSLATIONAL":
                load = by_force * across + by_bending * moment / overlap + by_twist * abs(M[2]) / twisting
                push[2] = braked(along, load, force)
            elif kind == "CYLINDRICAL":
                load, speed = by_force * across + by_bending * moment / overlap, np.hypot(along, pin * w[2]) + 1e-30
                push[2] = braked(speed, load, force) * along / speed
                turn[2] = braked(speed, pin * load, torque) * pin * w[2] / speed
            else:
                speed = pin * np.linalg.norm(w) + 1e-30
                turn[:] = braked(speed, by_force * pin * np.linalg.norm(F), torque) * pin * w / speed
            view.push(I, at, axes @ push, axes @ turn)
            view.push(J, at, -axes @ push, -axes @ turn)

        self.pressed.append(act)

    def led(self, number):
        """A torque by a part of a joint's reaction and by an input of the model."""
        i = self.pick(next(k for k, m in self.markers.items() if m.part < 0))
        j = self.pick(i)
        rm = int(self.rng.choice(list(self.markers)))
        _, joint, *ends = self.kinds[self.rng.integers(len(self.kinds))]
        keyword = "JPRIM" if f"JPRIM_{joint}" in self.equations else "JOINT"
        flag, component, share, size = (*self.rng.integers(0, [2, 3]), 0.02, self.rng.uniform(0.1, 0.5))
        x, f = self.length, self.force
        self.statement(f"VARIABLE/{number}", f"FUNCTION = {size / (f * x):.16g}")
        self.statement(f"PINPUT/{number}", f"VARIABLES = {number}")
        self.statement(
            f"SFORCE/{number}", "ROTATIONAL", f"I = {i}", f"J = {j}",
            f"FUNCTION = {share / x:.16g}*{keyword}({joint}, {flag}, {component + 2}, {rm})", f"+ PINVAL({number}, 1)*COS(4*TIME)",
        )  # fmt: skip
        I, J, R, seat = (self.markers[k] for k in (i, j, rm, ends[flag]))

        def act(view, pulls):
            force, _ = pulled(view, pulls, f"{keyword}_{joint}", seat)
            torque = (share * (view.axes(R).T @ force)[component] + size * np.cos(4 * view.t)) * view.axis(J, "z").value
            view.push(I, view.point(I).value, np.zeros(3), torque)
            view.push(J, view.point(J).value, np.zeros(3), -torque)

        self.pressed.append(act)


def random_statements(seed):
    """Two or three parts, of which the first joint rubs and one may be a bead, with a torque that hangs on a reaction."""
    trial = Statements(seed)
    rng = trial.rng
    trial.marker(-1, rng.uniform(-1, 1, 3), trial.turn())
    trial.body(str(rng.choice(RUBBING)), -1)
    if rng.random() < 0.6:
        trial.bead(int(rng.integers(-1, 1)))
    if len(trial.bodies) == 1 or rng.random() < 0.5:
        trial.body(str(rng.choice(list(KINDS))), int(rng.integers(-1, len(trial.bodies))))
    for kind, number, i, j in list(trial.kinds):
        if kind in RUBBING:
            trial.rub(kind, number, i, j)
    trial.led(40)
    trial.any_force(1)
    trial.requests()
    return trial
