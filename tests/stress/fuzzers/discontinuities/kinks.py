"""Random drives and forces with kinks at known times, against minimal equations integrated from kink to kink by SciPy."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator, PPoly

import stiffmbs
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.trajectory import Outcome as Ending

from ...case import Outcome, Verdict, measured, told

WHAT = "Random drives and forces with kinks (value, rate, acceleration) at known times against minimal equations."
SOLVERS: dict[str, dict[str, Any]] = {
    **{name: {"solver": name} for name in ("bdf", "radau", "auto")},
    **{f"bdf {name}": {"solver": "bdf", "formulation": name} for name in ("SI1", "I3", "index1")},
    **{f"radau {stages}": {"solver": "radau", "stages": stages} for stages in (3, 5, 7)},
    **{name: {"solver": "projected", "scheme": name} for name in ("dop853", "dopri5")},
    "rk4": {"solver": "projected", "scheme": "rk4", "step": 2e-4},
    "euler_cromer": {"solver": "projected", "scheme": "euler_cromer", "step": 1e-4},
}
GLOBAL = 300.0
"""Global error, relative to the tolerance and to 1 + the largest value, that steps may add up to."""
BY_VELOCITIES = 20.0
"""The same of I3, whose error test leaves out velocities, in addition."""
OF_FORCES = 1e4
"""The same of a drive's force, relative to the largest force."""
OF_ESTIMATE = 4.0
"""Error relative to its estimate up to which the run has told it; twice for the half angles of Euler parameters."""
FIXED = {"rk4": 1e-6, "euler_cromer": 2e-3}
"""Error that fixed steps may have."""
OF_HALF_STEPS = {"rk4": 0.1, "euler_cromer": 0.6}
"""Largest ratio of errors by half the step to these, up to which they are those of the order: 1/16 and 1/2."""
TOLD_JUMP = 0.03
"""Velocity jump, relative to the largest velocity there, that a note must report; below a tenth of it there is none."""
HALF_TURN = 3.0
"""Angle up to which the angle of a marker in space is that of the joint, rad."""
POINTS = 2, 3, 6, 11, 31, 101
Derivatives = tuple[float, float, float]


@dataclass(frozen=True)
class Signal:
    """Function of time: its text, its kinks, and its value, rate and acceleration at a time that is none of these."""

    text: str
    kinks: tuple[float, ...]
    at: Callable[[float], Derivatives]


def trial(seed: int) -> Verdict:
    """One random chain of bodies by one solver."""
    rng = np.random.default_rng(seed)
    return Chain(rng).judged(rng)


class Chain:
    """Bodies on one line or about one axis, of which some are led by drives relative to the one before.

    `signal[i]`: drive of body i relative to body i - 1 (to the ground for the first), or None if springs lead it.
    `stiffness`, `damping`: between body i and i - 1, where there is no drive. `force`: on body i.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self.kind, self.end = str(rng.choice(["slides", "turns", "turns in space"])), float(rng.choice([0.7, 1.0, 2.0]))
        self.count = int(rng.integers(1, 5))
        self.mass = 10.0 ** rng.uniform(-1, 1, self.count)
        self.stiffness = 10.0 ** rng.uniform(0, 3, self.count) * (rng.uniform(size=self.count) < 0.8)
        self.damping = 10.0 ** rng.uniform(-2, 4, self.count) * (rng.uniform(size=self.count) < 0.6)
        self.points = int(rng.choice(POINTS))
        self.tables: dict[str, Any] = {}
        instants = self._instants(rng)
        self.signal = [self._drive(rng, instants) if rng.uniform() < 0.5 else None for _ in range(self.count)]
        if self.count > 1 and self.signal[0] and rng.uniform() < 0.7:
            self.signal[0] = None  # a group of bodies that its drive does not lead by the ground
        self.force = [
            self._signal(rng, instants, 10.0, of_force=True) if rng.uniform() < 0.5 else None for _ in range(self.count)
        ]
        self.moving = rng.uniform(-1, 1, self.count) * (rng.uniform() < 0.5)
        kinks = [t for each in (*self.signal, *self.force) if each for t in each.kinks]
        times = np.unique([t for t in kinks if 0.0 < t < self.end])
        self.kinks = times[np.diff(times, append=np.inf) > 1e-12]  # 0.45 and 0.45 less one rounding are one kink

    def _instants(self, rng: np.random.Generator) -> list[float]:
        """Return a few times: at the start, at outputs, of tenths and between; one may follow another closely."""
        output = self.end * float(rng.integers(1, max(self.points - 1, 2))) / (self.points - 1)
        found = [0.0, self.end, output, 0.1 * int(rng.integers(1, 10)), *rng.uniform(0, self.end, 2).tolist()]
        chosen = [float(t) for t in rng.choice(found, 2)]
        return [*chosen, chosen[0] + float(10.0 ** rng.uniform(-6, -1))]

    def _signal(self, rng: np.random.Generator, instants: list[float], size: float, of_force: bool = False) -> Signal:
        parts = [self._part(rng, instants, size, of_force) for _ in range(int(rng.integers(1, 4)))]

        def at(t: float) -> Derivatives:
            value, rate, acceleration = np.sum([part.at(t) for part in parts], axis=0)
            return float(value), float(rate), float(acceleration)

        return Signal(" + ".join(part.text for part in parts), tuple(t for part in parts for t in part.kinks), at)

    def _drive(self, rng: np.random.Generator, instants: list[float]) -> Signal:
        """Return a signal that is zero at the start, where the bodies are described."""
        found = self._signal(rng, instants, 1.0)
        first = found.at(0.0)[0]

        def at(t: float) -> Derivatives:
            value, *others = found.at(t)
            return value - first, *others  # type: ignore[return-value]

        return Signal(f"{found.text} - {first!r}", found.kinks, at)

    def _part(self, rng: np.random.Generator, instants: list[float], size: float, of_force: bool) -> Signal:
        a, s = float(rng.uniform(-size, size)), float(rng.choice(instants))
        after = lambda t: float(t > s)  # noqa: E731
        kind = str(
            rng.choice(
                ["rate", "abs", "square", "step", "lines", "curve", "sine", *(["sign", "branch"] if of_force else [])]
            )
        )
        match kind:
            case "rate":
                return Signal(f"{a!r}*max(t - {s!r}, 0)", (s,), lambda t: (a * (t - s) * after(t), a * after(t), 0.0))
            case "abs":
                sense = lambda t: 1.0 if t > s else -1.0  # noqa: E731
                return Signal(f"{a!r}*abs(t - {s!r})", (s,), lambda t: (a * abs(t - s), a * sense(t), 0.0))
            case "square":
                return Signal(
                    f"{a!r}*max(t - {s!r}, 0)^2", (s,),
                    lambda t: (a * (t - s) ** 2 * after(t), 2 * a * (t - s) * after(t), 2 * a * after(t)),
                )  # fmt: skip
            case "sine":
                w = float(rng.uniform(1, 20))
                return Signal(
                    f"{a!r}*sin({w!r}*t)", (), lambda t: (a * np.sin(w * t), a * w * np.cos(w * t), -a * w * w * np.sin(w * t))
                )  # fmt: skip
            case "step":
                width = float(rng.choice([0.03, 0.2]))
                return Signal(f"step(t, {s!r}, 0, {s + width!r}, {a!r})", (s, s + width), _step(s, width, a))
            case "lines" | "curve":
                return self._table(rng, s, a, kind)
            case "sign":
                return Signal(f"{a!r}*sign(t - {s!r})", (s,), lambda t: (a if t > s else -a, 0.0, 0.0))
        return Signal(f"branch(t - {s!r}, 0, 0, {a!r})", (s,), lambda t: (a * after(t), 0.0, 0.0))

    def _table(self, rng: np.random.Generator, s: float, a: float, kind: str) -> Signal:
        """Return a table of straight lines, or a monotone curve, whose curvature jumps at its points."""
        x = np.unique([-1.0, s, s + 0.1, s + 0.25, 5.0])
        y = a * rng.uniform(-1, 1, len(x))
        name = f"table_{len(self.tables)}"
        self.tables[name] = {"table": np.column_stack([x, y]).tolist(), **({"lines": True} if kind == "lines" else {})}
        curve = PPoly([np.diff(y) / np.diff(x), y[:-1]], x) if kind == "lines" else PchipInterpolator(x, y)
        others = (
            [curve.derivative(order) for order in (1, 2)] if kind == "curve" else [curve.derivative(1), lambda t: 0.0]
        )

        def at(t: float) -> Derivatives:
            return float(curve(t)), float(others[0](t)), float(others[1](t))

        return Signal(f"{name}(t)", tuple(x.tolist()), at)

    def groups(self) -> list[list[int]]:
        """Return the bodies that drives connect; the first group contains -1 for the ground."""
        found = [[-1]]
        for i in range(self.count):
            if self.signal[i]:
                found[-1].append(i)
            else:
                found.append([i])
        return found

    def led(self, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return displacement, velocity and acceleration of each body relative to the first one of its group."""
        total = np.zeros((self.count, 3))
        for i, signal in enumerate(self.signal):
            if signal:
                total[i] = np.array(signal.at(t)) + (total[i - 1] if i else 0.0)
        return total[:, 0], total[:, 1], total[:, 2]

    def forces(self, t: float, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return the force on each body apart from those of drives."""
        found = np.array([signal.at(t)[0] if signal else 0.0 for signal in self.force])
        for i in range(self.count):
            if self.signal[i] is None:
                before = (x[i - 1], v[i - 1]) if i else (0.0, 0.0)
                pull = -self.stiffness[i] * (x[i] - before[0]) - self.damping[i] * (v[i] - before[1])
                found[i] += pull
                if i:
                    found[i - 1] -= pull
        return found

    def truth(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
        """Return positions, velocities and drive forces of bodies at given times, and the largest velocity jump.

        Those at a kink are just before it; those at the start just after it.
        """
        free = [group for group in self.groups() if group[0] >= 0]
        member = np.zeros((self.count, len(free)))
        for g, group in enumerate(free):
            member[group, g] = 1.0
        mass = member.T @ self.mass

        def bodies(t: float, y: np.ndarray, side: float) -> tuple[np.ndarray, np.ndarray]:
            d, rate, _ = self.led(t + side)
            first, speed = np.split(y, 2)
            return member @ first + d, member @ speed + rate

        def accelerations(t: float, y: np.ndarray, side: float) -> tuple[np.ndarray, np.ndarray]:
            x, v = bodies(t, y, side)
            f, given = self.forces(t + side, x, v), self.led(t + side)[2]
            return (member.T @ (f - self.mass * given)) / mass if len(free) else np.empty(0), f

        small, jump = 1e-13 * self.end, 0.0
        # bodies begin where the drives put them, with the velocities nearest to the described ones
        _, rate, _ = self.led(small)
        momentum = member.T @ (self.mass * (self.moving - rate))
        y = np.concatenate([np.zeros(len(free)), momentum / mass if len(free) else []])
        edges = [0.0, *self.kinks.tolist(), self.end]
        rows: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []

        def row(t: float, y: np.ndarray, side: float) -> None:
            x, v = bodies(t, y, side)
            a, f = accelerations(t, y, side)
            whole = member @ a + self.led(t + side)[2] if len(free) else self.led(t + side)[2]
            rows.append((x, v, self._drive_forces(self.mass * whole - f)))

        row(0.0, y, small)
        for begin, until in itertools.pairwise(edges):
            wanted = times[(times > begin + small) & (times <= until + small)]
            inside = np.minimum(wanted, until)
            if len(y):

                def rates(t: float, y: np.ndarray, b: float = begin, u: float = until) -> np.ndarray:
                    t = min(max(t, b + small), u - small)
                    return np.concatenate([y[len(free) :], accelerations(t, y, 0.0)[0]])

                found = solve_ivp(
                    rates, (begin, until), y, method="LSODA", rtol=1e-10, atol=1e-12, t_eval=np.unique([*inside, until])
                )
                states = dict(zip(found.t.tolist(), found.y.T, strict=True))
            for t in inside.tolist():
                row(t, states[t] if len(y) else y, -small if t >= until - small else 0.0)
            if until < self.end:
                if len(y):
                    y = states[until].copy()
                change = self.led(until + small)[1] - self.led(until - small)[1]
                speeds = bodies(until, y, -small)[1]
                if len(free):
                    y[len(free) :] -= member.T @ (self.mass * change) / mass
                after = bodies(until, y, small)[1]
                fastest = max(np.max(np.abs(speeds)), np.max(np.abs(after)), 1e-3)
                jump = max(jump, float(np.max(np.abs(after - speeds)) / fastest))
        x, v, force = (np.array(column) for column in zip(*rows, strict=True))
        return x, v, force, jump

    def _drive_forces(self, needed: np.ndarray) -> np.ndarray:
        """Return the force of each drive on its body from the forces that the bodies need."""
        found = needed.copy()
        for i in range(self.count - 2, -1, -1):
            if self.signal[i + 1]:
                found[i] += found[i + 1]
        return np.array([found[i] if signal else 0.0 for i, signal in enumerate(self.signal)])

    def scene(self) -> dict[str, Any]:
        """Return the scene, of prismatic joints in the plane or revolute joints in space."""
        given: dict[str, Any] = {"bodies": {}, "joints": {}, "forces": {}}
        x_name, v_name = {
            "slides": ("{}.x", "{}.vx"), "turns": ("{}.angle", "{}.omega"), "turns in space": ("az({})", "wz({})")
        }[self.kind]  # fmt: skip
        for i in range(self.count):
            before, own, speed = f"b{i - 1}" if i else "ground", float(self.mass[i]), float(self.moving[i])
            (x_0, v_0), (x, v), (x_1, v_1) = (
                (x_name.format(f"b{k}"), v_name.format(f"b{k}")) if k >= 0 else ("0", "0") for k in (i - 1, i, i + 1)
            )
            given["bodies"][f"b{i}"] = {
                "slides": {"mass": own, "inertia": 1, "velocity": [speed, 0]},
                "turns": {"mass": 1, "inertia": own, "omega": speed},
                "turns in space": {"mass": 1, "inertia": [own] * 3, "omega": [0, 0, speed]},
            }[self.kind]
            joint = "prismatic" if self.kind == "slides" else "revolute"
            given["joints"][f"j{i}"] = {"type": joint, "i": f"b{i}", "j": before}
            law = each.text if (each := self.force[i]) else "0"
            if signal := self.signal[i]:
                given["joints"][f"d{i}"] = {"type": "drive", "joint": f"j{i}", "position": signal.text}
            else:
                law += f" - {float(self.stiffness[i])!r}*({x} - {x_0}) - {float(self.damping[i])!r}*({v} - {v_0})"
            if i + 1 < self.count and not self.signal[i + 1]:
                k, c = float(self.stiffness[i + 1]), float(self.damping[i + 1])
                law += f" + {k!r}*({x_1} - {x}) + {c!r}*({v_1} - {v})"
            acting: dict[str, dict[str, Any]] = {
                "slides": {"type": "force", "force": [law, 0]},
                "turns": {"type": "torque", "torque": law},
                "turns in space": {"type": "torque", "torque": [0, 0, law]},
            }
            given["forces"][f"f{i}"] = {**acting[self.kind], "i": f"b{i}"}
        if self.kind == "turns in space":
            given["dimensions"] = 3
        if self.tables:
            given["tables"] = self.tables
        return given

    def judged(self, rng: np.random.Generator) -> Verdict:
        """Run by a random solver, in one run or step by step, and compare."""
        times = np.linspace(0.0, self.end, self.points)
        x_true, v_true, force_true, jump = self.truth(times)
        if self.kind == "turns in space" and np.abs(x_true).max() > HALF_TURN:
            self.kind = "turns"  # az counts no turns
        name = str(rng.choice([*SOLVERS]))
        rtol, stepwise = float(10.0 ** rng.integers(-9, -4)), bool(rng.uniform() < 0.2)
        detail = f"{name}, rtol {rtol:.0e}, {self.points} points, {'stepwise, ' if stepwise else ''}{json.dumps(self.scene())}"
        how = {"duration": self.end, "points": self.points, "rtol": rtol, **SOLVERS[name]}
        try:
            found = self._stepwise(how) if stepwise else self._run(how)
        except StiffmbsError as refusal:
            return told(f"{refusal} [{detail}]", ())
        if isinstance(found, str):
            if name in FIXED:  # too stiff for its steps
                return told(f"{found} [{detail}]", ("t = ",))
            return Verdict(Outcome.WRONG, detail=f"{found} [{detail}]")
        x, v, force, notes = found
        truth = x_true, v_true, force_true
        part = GLOBAL * rtol * (BY_VELOCITIES if "I3" in name else 1.0)
        allowed = max(part, FIXED.get(name, 0.0))
        *errors, of_forces = self._errors((x, v, force), truth)
        error = max(*errors, of_forces * part / (OF_FORCES * rtol) if name not in FIXED else 0.0)
        reported = any("velocities jump" in note for note in notes)
        if notes and jump > TOLD_JUMP and not reported:
            return Verdict(Outcome.WRONG, jump, TOLD_JUMP, f"a velocity jump is not reported: {detail}")
        if reported and jump < 0.1 * TOLD_JUMP:
            return Verdict(Outcome.WRONG, jump, TOLD_JUMP, f"a velocity jump is reported where there is none: {detail}")
        if false := [note for note in notes if "missed" in note or "doubt" in note or "positions jump" in note]:
            return Verdict(Outcome.WRONG, error, allowed, f"{false[0]}: {detail}")
        if error > allowed and name in FIXED and self._converges(max(errors), truth, name, how):
            return Verdict(Outcome.RIGHT, error, allowed, f"converges by its order: {detail}")
        if error > allowed and name not in FIXED and not stepwise and self._is_estimated(errors, truth, how):
            return told(f"as the run estimates: {errors} [{detail}]", ())
        return measured(error, allowed, f"{errors} {of_forces:.2g} {detail}")

    def _is_estimated(self, errors: Sequence[float], truth: Sequence[np.ndarray], how: dict[str, Any]) -> bool:
        """Return True if the errors of positions and velocities are those that the run estimates."""
        solution = stiffmbs.run(read_scene(json.dumps(self.scene())), **how, errors=True)
        place, speed = {"slides": ("x", "vx"), "turns": ("angle", "omega"), "turns in space": ("q3", "wz")}[self.kind]
        return bool(solution.errors) and all(
            error <= OF_ESTIMATE * max(solution.errors[f"b{i}.{name}"].over_time for i in range(self.count)) / (1.0 + np.abs(of).max())
            for error, of, name in zip(errors, truth, (place, speed), strict=False)
        )  # fmt: skip

    def _errors(self, found: Sequence[np.ndarray], truth: Sequence[np.ndarray]) -> list[float]:
        """Return the errors of positions, velocities and forces, relative to 1 + the largest value."""
        return [
            float(np.max(np.abs(a - b))) / (1.0 + float(np.max(np.abs(b)))) for a, b in zip(found, truth, strict=True)
        ]

    def _converges(self, error: float, truth: Sequence[np.ndarray], name: str, how: dict[str, Any]) -> bool:
        """Return True if half the fixed step reduces the error of positions and velocities as its order does."""
        halved = self._run({**how, "step": 0.5 * how["step"]})
        return not isinstance(halved, str) and max(self._errors(halved[:2], truth[:2])) <= OF_HALF_STEPS[name] * error

    def _run(self, how: dict[str, Any]) -> Any:
        solution = stiffmbs.run(read_scene(json.dumps(self.scene())), **how)
        if solution.outcome is not Ending.DONE:
            return solution.message
        return *self._columns(solution), (solution.message, *solution.notes)

    def _stepwise(self, how: dict[str, Any]) -> Any:
        simulation = stiffmbs.simulation(read_scene(json.dumps(self.scene())), **how)
        rows = [self._columns(simulation)]
        for dt in np.diff(np.linspace(0.0, self.end, self.points)):
            simulation.step(float(dt))
            rows.append(self._columns(simulation))
        return *(np.array(column) for column in zip(*rows, strict=True)), ()

    def _columns(self, channels: Any) -> tuple[np.ndarray, ...]:
        """Return positions, velocities and forces of drives, the bodies in the last axis."""
        v, force = {"slides": ("vx", "fx"), "turns": ("omega", "torque"), "turns in space": ("wz", "tz")}[self.kind]
        names = [f"b{i}" for i in range(self.count)]
        if self.kind == "turns in space":  # the angles of joints count turns by rates, which are high after some starts
            places = np.array([2.0 * np.arctan2(channels[f"{name}.q3"], channels[f"{name}.q0"]) for name in names])
        else:
            places = np.array([channels[f"{name}.{'x' if self.kind == 'slides' else 'angle'}"] for name in names])
        speeds = np.array([channels[f"{name}.{v}"] for name in names])
        led = [channels[f"d{i}.{force}"] if self.signal[i] else 0.0 * speeds[0] for i in range(self.count)]
        return places.T, speeds.T, np.array(led).T


def _step(s: float, width: float, a: float) -> Callable[[float], Derivatives]:
    """Return the derivatives of Adams' STEP from 0 to a."""

    def at(t: float) -> Derivatives:
        z = (t - s) / width
        if not 0.0 < z < 1.0:
            return a * float(z >= 1.0), 0.0, 0.0
        return a * z * z * (3 - 2 * z), a * 6 * z * (1 - z) / width, a * (6 - 12 * z) / width**2

    return at
