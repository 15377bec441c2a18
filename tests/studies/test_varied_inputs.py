"""Inputs of a simulation in formulas of time: breakpoints move with each change, and none is missed."""

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
    ),
    "pulse": (
        "1e3*(step(t, V, 0, V + 2e-3, 1) - step(t, V + 4e-3, 0, V + 6e-3, 1))",
        lambda V, t: 1e3 * (ramp(t, V, V + 2e-3) - ramp(t, V + 4e-3, V + 6e-3)),
    ),
    "smooth pulse": ("50*exp(-((t - V)/0.01)^2)", lambda V, t: 50.0 * np.exp(-(((t - V) / 0.01) ** 2))),
    "sine": ("k*sin(V*t + a)", lambda V, t: 20.0 * np.sin(V * t + 0.3)),
    "corners": ("k*abs(sin(V*t))*V", lambda V, t: 20.0 * V * abs(np.sin(V * t))),
}
SOLVERS = {
    "bdf": {"solver": "bdf"},
    "radau": {"solver": "radau"},
    "rk4": {"solver": "projected", "scheme": "rk4", "step": 2e-4},
    "dop853": {"solver": "projected", "scheme": "dop853"},
}


def values(seed):
    """Return the values of V at each step: near one, over a wide range, or equal in some steps."""
    random = np.random.default_rng(seed)
    found = random.uniform(0.2, 3.0, 40) if seed % 2 else 0.2 + 0.05 * random.random(40)
    return [float(found[k // 4 * 4 if seed % 3 == 0 else k]) for k in range(len(found))]


@pytest.mark.sampled(6)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("law", LAWS)
def test_a_law_whose_input_changes_at_each_step_is_followed(law, seed, solver):
    """m x'' + c x' + k x = F(V, t), with V constant within each step, by SciPy."""
    text, force = LAWS[law]
    given, dt = values(seed), 0.02
    sim = simulation(stiffmbs.read_scene(SCENE.replace("LAW", text)), inputs={"V": given[0]}, **SOLVERS[solver])
    assert sim._inputs.affine and sim._inputs.of_time
    y = np.zeros(2)
    for k, V in enumerate(given):
        sim.step(dt, {"V": V})
        span, most = (k * dt, (k + 1) * dt), 1e-3 if "pulse" in law else 1e-2
        y = solve_ivp(
            lambda t, y, V=V: [y[1], force(V, t) - 30.0 * y[0] - 1.5 * y[1]],
            span,
            y,
            rtol=1e-9,
            atol=1e-11,
            max_step=most,
        ).y[:, -1]
    assert sim["sled.x"] == pytest.approx(y[0], abs=1e-6 * max(1.0, np.abs(y).max()))
    assert sim["sled.vx"] == pytest.approx(y[1], abs=1e-6 * max(1.0, np.abs(y).max()))


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
