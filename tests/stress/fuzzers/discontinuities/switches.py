"""Vibrations that touch windows, and friction loads that change sign, against quadratures and a piecewise integration."""

from __future__ import annotations

import numpy as np
from scipy.integrate import quad, solve_ivp

import stiffmbs
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Outcome as Ended

from ...case import Outcome, Verdict, measured

WHAT = "fast vibrations that touch windows (even seeds), and guides whose friction loads change sign (odd): against own integration"
PER_EVENT = 50.0
"""Allowed error for each event, in tolerances: a restart begins with steps of first order."""


def trial(seed: int) -> Verdict:
    """Solve one scene; it has a solution, so that a stop is wrong."""
    rng = np.random.default_rng(seed)
    return _guide(rng) if seed % 2 else _window(rng)


def _run(scene: Scene, rng: np.random.Generator) -> tuple[Solution | None, float, str]:
    rtol, points = float(10 ** rng.uniform(-8.0, -5.0)), int(rng.choice([2, 3, 6, 11, 101]))
    try:
        found = stiffmbs.run(scene, solver="bdf", duration=1.0, rtol=rtol, points=points)
    except StiffmbsError as refusal:
        return None, rtol, str(refusal)
    words = f"rtol {rtol:.1e}, {points} points, {found.solver.get('events')} events; {found.message}"
    return (found if found.outcome is Ended.DONE else None), rtol, words


def _window(rng: np.random.Generator) -> Verdict:
    """A vibration or a rotation touches a stop in each period, which moves another body to 1 m/s in all."""
    w, part = float(rng.uniform(20.0, 400.0)), float(1 - 10 ** rng.uniform(-2.5, 0.0))
    phase, turns = float(rng.uniform(-3.0, 3.0)), bool(rng.random() < 0.5)
    half = np.arccos(part)
    closed = [((2 * np.pi * k - half - phase) / w, (2 * np.pi * k + half - phase) / w) for k in range(-2, 70)]
    within = [(max(a, 0.0), min(b, 1.0)) for a, b in closed if b > 0.0 and a < 1.0]
    touched = sum(quad(lambda t: np.cos(w * t + phase) - part, a, b)[0] for a, b in within)
    if not touched > 0.0:
        return Verdict(Outcome.TOLD, detail="no touch")
    if turns:
        start, law, what = f"angle: {phase}, omega: {w}", "", "cos(q.angle)"
    else:
        start = f"position: [{np.cos(phase)}, 0], velocity: [{-w * np.sin(phase)}, 0]"
        law, what = f"  s: {{type: force, i: q, force: ['-{w}^2*q.x', 0]}}\n", "q.x"
    scene = read_scene(
        f"gravity: [0, 0]\nbodies:\n  q: {{mass: 1, inertia: 1, {start}}}\n  b: {{mass: 1, inertia: 1, position: [0, 1]}}\n"
        f"joints: {{r: {{type: {'revolute' if turns else 'prismatic'}, i: q, j: ground}}, "
        "g: {type: prismatic, i: b, j: {body: ground, point: [0, 1]}}}\n"
        f"forces:\n{law}  f: {{type: force, i: b, force: ['{1 / touched!r}*max({what} - {part!r}, 0)', 0]}}\n"
    )
    found, rtol, words = _run(scene, rng)
    words = f"{what}, w = {w:.4g}, c = {part:.5g}, {words}"
    if found is None:
        return Verdict(Outcome.WRONG, detail=words)
    amplified = rtol * w / (1 - part) + PER_EVENT * rtol * len(within)
    return measured(abs(float(found["b.vx"][-1]) - 1.0), 0.3 / len(within) + 10 * amplified, words)


def _guide(rng: np.random.Generator) -> Verdict:
    """A slider with v' = (F - mu (N + |M|/(L/2)) tanh(v/v_s))/m, in which the friction has a lever on the moment M."""
    w, size, phase, mean = (
        rng.uniform(1.0, 300.0),
        rng.uniform(1.0, 40.0),
        rng.uniform(-3.0, 3.0),
        rng.uniform(-8.0, 8.0),
    )
    push, press, mu, length = rng.uniform(5.0, 30.0), rng.uniform(0.0, 20.0), rng.uniform(0.05, 0.3), 0.4
    fed_back, smooth, speed = rng.uniform(-0.95, 0.95), float(rng.choice([1e-4, 1e-2])), rng.uniform(0.5, 2.0)
    lever = fed_back * length / 2 / mu

    def moment(t: float) -> float:
        return float(size * np.cos(w * t + phase) + mean)

    def unloaded(t: float, v: float) -> float:
        """The moment times 1 - sign(M) c, with the feedback c of the friction."""
        return float(-moment(t) + lever * mu * press * np.tanh(v / smooth))

    def rate(t: float, y: np.ndarray, sign: float) -> list[float]:
        grip = float(np.tanh(y[0] / smooth))
        pressed = sign * unloaded(t, y[0]) / (1 - sign * fed_back * grip)
        return [(push - mu * (press + pressed * 2 / length) * grip) / 2]

    t, y, changes = 0.0, np.array([speed]), 0
    sign = 1.0 if unloaded(t, speed) > 0.0 else -1.0
    while t < 1.0:

        def vanishes(t: float, y: np.ndarray, sign: float) -> float:
            return sign * unloaded(t, y[0]) + 1e-13

        vanishes.terminal, vanishes.direction = True, -1.0  # type: ignore[attr-defined]
        part = solve_ivp(
            rate, (t, 1.0), y, "LSODA", events=vanishes, args=(sign,), rtol=1e-11, atol=1e-12, max_step=0.3 / w
        )
        t, y, sign, changes = float(part.t[-1]), part.y[:, -1], -sign, changes + 1
        if changes > 1000 or not part.success:
            return Verdict(Outcome.TOLD, detail="the check does not end")
    scene = read_scene(
        f"gravity: [0, 0]\nbodies: {{b: {{mass: 2, inertia: 0.07, velocity: [{speed}, 0]}}}}\n"
        f"joints: {{j: {{type: prismatic, i: {{body: b, point: [0, {-lever!r}]}}, j: {{body: ground, point: [0, {-lever!r}]}}}}}}\n"
        f"forces:\n  n: {{type: force, i: b, force: [{push}, {-press}]}}\n"
        f"  m: {{type: torque, i: b, torque: '{size!r}*cos({w!r}*t + {phase!r}) + {mean!r}'}}\n"
        f"  fr: {{type: joint_friction, joint: j, friction: {mu}, length: {length}, stiction_velocity: {smooth}}}\n"
    )
    found, rtol, words = _run(scene, rng)
    words = f"w = {w:.4g}, c = {fed_back:.3g}, v_s = {smooth:g}, {changes - 1} changes of sign, {words}"
    if found is None:
        return Verdict(Outcome.WRONG, detail=words)
    end = float(y[0])
    allowed = PER_EVENT * rtol * (changes + 3) * (1 + abs(end) + speed) / (1 - abs(fed_back))
    return measured(abs(float(found["b.vx"][-1]) - end), allowed, words)
