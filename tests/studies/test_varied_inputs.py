"""Inputs of a simulation in formulas of time: breakpoints move with each change, and none is missed."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import simulation
from stiffmbs.compile.inputs import calm
from stiffmbs.dynamics import dynamics
from stiffmbs.studies.varied_input import VariedInput

SCENE = """
parameters: {V: 1, k: 20, a: 0.3}
bodies: {sled: {mass: 1, inertia: 1}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  push: {type: force, i: sled, force: ["LAW", 0]}
  spring: {type: force, i: sled, force: ["-30*sled.x - 1.5*sled.vx", 0]}
run: {duration: 2, rtol: 1e-8}
"""


def ramp(t, begin, end):
    """Return the cubic step of a scene."""
    z = np.clip((t - begin) / (end - begin), 0.0, 1.0)
    return z * z * (3.0 - 2.0 * z)


LAWS = {
    "bump": (
        "0.5*k*(1 - cos(pi*min(max(V*t - a, 0), 2)))",
        lambda V, t: 10.0 * (1.0 - np.cos(np.pi * min(max(V * t - 0.3, 0.0), 2.0))),
        lambda V: [0.3 / V, 2.3 / V],
        3.0,
    ),
    "pulse": (
        "4e4*(step(t, V, 0, V + 1e-5, 1) - step(t, V + 2e-5, 0, V + 3e-5, 1))",
        lambda V, t: 4e4 * (ramp(t, V, V + 1e-5) - ramp(t, V + 2e-5, V + 3e-5)),
        lambda V: [V, V + 1e-5, V + 2e-5, V + 3e-5],
        0.3,
    ),
    "smooth pulse": (
        "5e3*exp(-((t - V)/1e-4)^2)",
        lambda V, t: 5e3 * np.exp(-(((t - V) / 1e-4) ** 2)),
        lambda V: [V - 1e-3, V, V + 1e-3],
        0.3,
    ),
    "sine": ("k*sin(V*t + a)", lambda V, t: 20.0 * np.sin(V * t + 0.3), lambda V: [], 9.0),
    "corners": (
        "k*abs(sin(V*t))*V",
        lambda V, t: 20.0 * V * abs(np.sin(V * t)),
        lambda V: [k * np.pi / V for k in range(9)],
        9.0,
    ),
}
"""Force, the same in Python, its breakpoints, and a typical value of V."""
SOLVERS = {
    "bdf": {"solver": "bdf"},
    "radau": {"solver": "radau"},
    "rk4": {"solver": "projected", "scheme": "rk4", "step": 2e-5},
    "dop853": {"solver": "projected", "scheme": "dop853"},
}


def values(seed, typical=0.3):
    """Return the values of V at each step: near a typical one, over a wide range, or equal in some steps."""
    random = np.random.default_rng(seed)
    found = typical * (random.uniform(0.5, 1.5, 40) if seed % 2 else 1.0 + 0.1 * random.random(40))
    return [float(found[k // 4 * 4 if seed % 3 == 0 else k]) for k in range(len(found))]


def exact(law, given, dt):
    """Return x and x' of m x'' + c x' + k x = F(V, t) at the end, by SciPy, from breakpoint to breakpoint."""
    _, force, breakpoints, _ = LAWS[law]
    y = np.zeros(2)
    for k, V in enumerate(given):
        within = [t for t in breakpoints(V) if k * dt < t < (k + 1) * dt]
        for begin, end in pairwise([k * dt, *within, (k + 1) * dt]):
            y = solve_ivp(
                lambda t, y, V=V: [y[1], force(V, t) - 30.0 * y[0] - 1.5 * y[1]], (begin, end), y, rtol=1e-9, atol=1e-11,
                method="DOP853",
            ).y[:, -1]  # fmt: skip
    return y


@pytest.mark.sampled(6)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("law", LAWS)
def test_a_law_whose_input_changes_at_each_step_is_followed(law, seed, solver):
    """The value of V is constant within each step."""
    given, dt = values(seed, LAWS[law][3]), 0.02
    sim = simulation(stiffmbs.read_scene(SCENE.replace("LAW", LAWS[law][0])), inputs={"V": given[0]}, **SOLVERS[solver])
    assert sim._inputs.affine and sim._inputs.of_time
    for V in given:
        sim.step(dt, {"V": V})
    expected = exact(law, given, dt)
    off = 1e-6 * max(1.0, np.abs(expected).max())
    np.testing.assert_allclose([sim["sled.x"], sim["sled.vx"]], expected, rtol=0, atol=off)


@pytest.mark.parametrize("law", ["pulse", "smooth pulse"])
def test_a_pulse_much_shorter_than_a_step_is_not_missed(law):
    given = [0.03] * 3 + [
        0.071,
        0.072,
        0.15,
        0.1501,
    ]  # reached in the second and fourth step, passed over before the sixth
    sim = simulation(stiffmbs.read_scene(SCENE.replace("LAW", LAWS[law][0])), inputs={"V": 0.03})
    for V in given:
        sim.step(0.02, {"V": V})
    assert sim["sled.vx"] == pytest.approx(exact(law, given, 0.02)[1], abs=1e-6)
    assert sim["sled.vx"] > 0.5


SPEED = {"V": 15.0}


def drive(sim, steps=60):
    """Return the states of a half car whose speed changes at each step."""
    found = []
    for k in range(steps):
        sim.step(5e-3, {"V": 15.0 + np.sin(0.3 * k)})
        found.append(np.concatenate([sim.q, sim.u]))
    return np.array(found)


def test_the_speed_of_a_half_car_changes_without_reading_the_scene(examples, monkeypatch):
    """Only where the wheels meet the bump, and for bounds of the speed. A fresh simulation and a reset give the same states."""
    path, counted = examples / "half_car.yaml", []
    sim = simulation(path, inputs=SPEED, rtol=1e-8)
    read, own, found = [], sim._inputs._solver.scene, dynamics.input_features
    sim._inputs._solver.scene = lambda values: read.append(values) or own(values)
    monkeypatch.setattr(dynamics, "input_features", lambda *given: counted.append(given) or found(*given))
    states = drive(sim)
    assert len(read) < 15 and len(counted) < 10
    sim.reset()
    np.testing.assert_array_equal(drive(sim), states)
    monkeypatch.setattr(VariedInput, "is_calm", lambda self, t, end: False)
    np.testing.assert_allclose(drive(simulation(path, inputs=SPEED, rtol=1e-8)), states, rtol=0, atol=1e-7)


def test_explicit_steps_are_the_same_to_the_last_bit_after_other_values():
    """Whether the elements were read at a step, or times without features were known, changes nothing."""
    scene = stiffmbs.read_scene(SCENE.replace("LAW", LAWS["bump"][0]).replace("V: 1,", "V: 1, W: 0.1*V,"))
    sim, fresh = (simulation(scene, inputs={"V": 0.7}, **SOLVERS["rk4"]) for _ in range(2))
    for V in values(1, 3.0):
        sim.step(0.02, {"V": V})
    sim.reset()
    for k, V in enumerate(values(2, 3.0)):
        sim.step(0.02, {"V": V})
        fresh.step(0.02, {"V": V})
        np.testing.assert_array_equal(np.append(sim.q, sim.u), np.append(fresh.q, fresh.u), f"step {k}")


def test_the_speed_set_from_the_start_gives_the_same_motion(examples):
    path = examples / "half_car.yaml"
    sim = simulation(path, inputs=SPEED, rtol=1e-9)
    for k in range(80):
        sim.step(5e-3, {"V": 12.0} if k % 2 else [12.0])
    expected = stiffmbs.run(stiffmbs.load_scene(path, [("V", 12.0)]), duration=0.4, points=2, rtol=1e-9)
    for channel in ("chassis.y", "chassis.angle", "front.vy", "rear.omega"):
        assert sim[channel] == pytest.approx(expected[channel][-1], abs=1e-7), channel


def test_a_scene_with_two_such_inputs_is_read_at_each_change():
    text = (
        SCENE.replace("LAW", "k*sin(V*t + a)")
        .replace("V: 1", "W: 0, V: 1")
        .replace("-30*sled.x", "-30*sled.x + sin(W*t)")
    )
    sim = simulation(stiffmbs.read_scene(text), inputs={"V": 1.0, "W": 0.0})
    assert not sim._inputs.affine
    sim.step(0.1, {"V": 2.0, "W": 3.0})
    expected = stiffmbs.run(stiffmbs.read_scene(text), duration=0.1, points=2)
    assert sim["sled.x"] != pytest.approx(expected["sled.x"][-1], rel=1e-3)


def searched(monkeypatch, change=1e-4, **tuning):
    """Return the numbers of searches over the duration, and over a step, where the speed changes slowly."""
    found, own = [], calm.CalmTimes.__init__

    def init(self, inputs, start, end, cells):
        found.append(cells)
        own(self, inputs, start, end, cells)

    with monkeypatch.context() as patch:
        patch.setattr(calm.CalmTimes, "__init__", init)
        scene = stiffmbs.read_scene(SCENE.replace("LAW", LAWS["bump"][0]))
        sim = simulation(scene, inputs={"V": 1.0}, tuning={"stepping": tuning}, **SOLVERS["rk4"])
        for k in range(400):
            sim.step(1e-3, {"V": 1.0 + change * k})
    return len(found) - found.count(1), found.count(1)


def test_wider_bounds_are_searched_less_often_and_leave_out_more(monkeypatch):
    counts = [searched(monkeypatch, reach=reach) for reach in (0.01, 0.02, 0.04)]
    assert counts[0][0] > counts[1][0] > counts[2][0] and counts[0][1] < counts[1][1] < counts[2][1]


def test_shorter_intervals_leave_out_less(monkeypatch):
    counts = [searched(monkeypatch, 1e-9, cells=cells, reach=1e-6)[1] for cells in (512, 1024, 2048)]
    assert counts[0] > counts[1] > counts[2]
