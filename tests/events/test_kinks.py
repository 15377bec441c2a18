"""Kinks of drives and forces at known times: a step ends before each and the next begins after it, in every solver."""

import functools
import itertools
import json

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.linalg import expm

import stiffmbs
from stiffmbs.compile.inputs.features import breakpoint_times
from stiffmbs.compile.inputs.of_time import inputs_of

SOLVERS = {
    **{name: {"solver": name} for name in ("bdf", "radau", "auto")},
    **{name: {"solver": "bdf", "formulation": name} for name in ("SI1", "I3", "index1", "SI2_exact")},
    **{f"radau {stages}": {"solver": "radau", "stages": stages} for stages in (3, 5, 7)},
    **{name: {"solver": "projected", "scheme": name} for name in ("dop853", "dopri5")},
    "rk4": {"solver": "projected", "scheme": "rk4", "step": 2e-4},
}
EVERY = pytest.mark.parametrize("how", SOLVERS.values(), ids=SOLVERS)


def sled(position, **more):
    """Return the scene of a sled led by a drive."""
    joints = {
        "rail": {"type": "prismatic", "i": "sled", "j": "ground"},
        "lead": {"type": "drive", "joint": "rail", "position": position},
    }
    return stiffmbs.read_scene(json.dumps({"bodies": {"sled": {"mass": 1, "inertia": 1}}, "joints": joints, **more}))


def platform(position):
    """Return the scene of a rotor that a drive turns on a platform with a stiff brake."""
    return stiffmbs.read_scene(
        json.dumps(
            {
                "bodies": {"platform": {"mass": 10, "inertia": 10}, "rotor": {"mass": 1, "inertia": 1}},
                "joints": {
                    "bearing": {"type": "revolute", "i": "platform", "j": "ground"},
                    "shaft": {"type": "revolute", "i": "rotor", "j": "platform"},
                    "drive": {"type": "drive", "joint": "shaft", "position": position},
                },
                "forces": {
                    "brake": {"type": "torque", "i": "platform", "torque": "-1e5*platform.angle - 3000*platform.omega"}
                },
            }
        )
    )


def braked(t):
    """Return the platform's angular velocity a time after the kick of its rotor: 11 a'' + 3000 a' + 1e5 a = 0."""
    slow, fast = sorted(np.roots([11, 3000, 1e5]), key=abs)
    return -2 / 11 / (slow - fast) * (slow * np.exp(slow * t) - fast * np.exp(fast * t))


@EVERY
def test_a_drive_sets_a_body_at_rest_in_motion(how):
    """Just after that time, the velocity is rounding, and no measure of the first step."""
    solution = stiffmbs.run(sled("step(t, 0.4, 0, 0.43, -0.38)"), duration=0.7, points=2, **{"rtol": 1e-9} | how)
    assert solution.message == "completed"
    assert solution["sled.x"][-1] == pytest.approx(-0.38, abs=1e-6)


KINKS = {
    "at an output": (1.0, "2*max(t - 1, 0)", {"output": 0.01}),
    "between outputs": (1.0, "2*max(t - 1, 0)", {"points": 7}),
    "at a rounded output": (0.7, "2*max(t - 7*0.1, 0)", {"output": 0.1}),
    "at a table's point": (0.9, {"table": [[0, 0], [0.9, 0], [3, 4.2]], "lines": True}, {"output": 0.03}),
    "at the start": (0.0, "2*max(t, 0)", {"output": 0.01}),
}


@pytest.mark.sampled(16)
@EVERY
@pytest.mark.parametrize("kink", KINKS)
def test_a_drive_with_a_kink_pushes_the_body_that_carries_it(kink, how):
    """The momentum of platform and rotor together does not change at the kink; the row there is of one side."""
    begins, position, grid = KINKS[kink]
    solution = stiffmbs.run(platform(position), duration=1.2, **grid, **how)
    after = solution.time > begins + 1e-9
    allowed = 3e-4 if how.get("formulation") == "I3" else 1e-5
    error = np.abs(solution["platform.omega"][after] - braked(solution.time[after] - begins))
    assert error.max() < allowed
    (at,) = np.flatnonzero(np.abs(solution.time - begins) < 1e-9)[:1] if grid != {"points": 7} else (-1,)
    channels = [solution[name][at] for name in ("rotor.omega", "platform.omega", "drive.torque")]
    if begins == 0.0:
        np.testing.assert_allclose(channels, [20 / 11, -2 / 11, 3000 * 2 / 11 / 11], rtol=1e-9)
        assert solution.time[0] == 0.0
    elif at >= 0:
        np.testing.assert_allclose(channels, 0.0, atol=1e-9)
        assert any("a drive makes velocities jump (rotor.omega by 1.82, 100 %" in note for note in solution.notes)


@pytest.mark.sampled(4)
@EVERY
def test_forces_jump_at_the_points_of_a_curve_that_a_drive_follows(how):
    """The second derivative of a monotone curve (PCHIP) jumps at its points, and the body that carries the drive feels it."""
    x, y = np.array([0, 0.13, 0.31, 0.4, 0.66, 0.9, 1.2]), np.array([0, 0.6, -0.5, 0.6, 0.2, -0.8, -0.1])
    curve = PchipInterpolator(x, y)
    state, expected = [0.0, -curve.derivative()(0.0) / 11], [-curve.derivative()(0.0) / 11]
    for (begin, end), a, b in zip(itertools.pairwise(x), *curve.c[:2], strict=True):
        rates = np.array([[0, 1, 0, 0], [-1e5, -3000, -6 * a, -2 * b], [0, 0, 0, 11], [0, 0, 0, 0]])  # of a, a', t, 1
        rates[1:] /= 11
        state = (expm(rates * (end - begin)) @ [*state, 0, 1])[:2]
        expected.append(state[1])
    rtol = 1e-7
    scene = platform({"table": np.column_stack([x, y]).tolist()})
    solution = stiffmbs.run(scene, duration=1.2, output=0.01, rtol=rtol, **how)
    rows = [int(np.argmin(np.abs(solution.time - t))) for t in x]
    allowed = 5e-5 if how.get("formulation") == "I3" else 20 * rtol
    np.testing.assert_allclose(
        solution["platform.omega"][rows], expected, atol=max(allowed, 2e-8 if "step" in how else 0)
    )


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", ["bdf", "radau", "auto", "dop853", "rk4"])
@pytest.mark.parametrize("kink", ["at an output", "at a rounded output", "at the start"])
def test_steps_of_a_simulation_end_before_a_kink_and_begin_after_it(kink, name):
    begins, position, grid = KINKS[kink]
    simulation = stiffmbs.simulation(platform(position), duration=1.2, **SOLVERS[name])
    assert simulation.t == 0.0
    assert simulation["rotor.omega"] == pytest.approx(20 / 11 if begins == 0.0 else 0.0)
    while simulation.t < begins + 0.105:
        simulation.step(grid["output"])
        expected = braked(simulation.t - begins) if simulation.t > begins + 1e-9 else 0.0
        assert simulation["platform.omega"] == pytest.approx(expected, abs=1e-5)


@pytest.mark.sampled(12)
@EVERY
def test_the_end_does_not_depend_on_output_points(how):
    """Two drives with kinks at the same time, and a force that jumps then, between and at output points."""
    scene = stiffmbs.read_scene(
        json.dumps(
            {
                "bodies": {name: {"mass": mass, "inertia": 1} for name, mass in (("a", 3), ("b", 2), ("c", 1))},
                "joints": {
                    "first": {"type": "prismatic", "i": "a", "j": "ground"},
                    "second": {"type": "prismatic", "i": "b", "j": "a"},
                    "third": {"type": "prismatic", "i": "c", "j": "b"},
                    "lead": {"type": "drive", "joint": "second", "position": "0.3*abs(t - 0.7) - 0.21"},
                    "other": {"type": "drive", "joint": "third", "position": "max(t - 0.7, 0)^2 - max(t - 0.35, 0)"},
                },
                "forces": {"spring": {"type": "force", "i": "a", "force": ["-100*a.x - 5*a.vx + 10*sign(t - 0.7)", 0]}},
            }
        )
    )
    rtol = 1e-7
    ends = []
    for points in (2, 3, 6, 11, 101, 1001):
        solution = stiffmbs.run(scene, duration=1.4, points=points, rtol=rtol, **how)
        ends.append([solution[name][-1] for name in ("a.x", "a.vx", "c.x", "c.vx")])
    assert np.ptp(ends, axis=0).max() < (100 if how.get("formulation") == "I3" else 10) * rtol * (
        1 + np.abs(ends).max()
    )


@pytest.mark.sampled(4)
@pytest.mark.parametrize("how", [*SOLVERS.values(), {"solver": "kinematic"}], ids=[*SOLVERS, "kinematic"])
def test_a_velocity_jump_is_measured_by_the_velocities_of_the_run(how):
    def notes(position):
        return " ".join(stiffmbs.run(sled(position), duration=2.0, points=11, **how).notes)

    assert "a drive makes velocities jump (sled.vx by -0.005, 100 % of the largest" in notes("5e-3*min(t, 1)")
    assert "jump" not in notes("1*min(t, 1) + (0.999 + 1e-5)*max(t - 1, 0)")  # 0.1 %
    assert "jump" not in notes("1e-12*min(t, 1)")  # below the tolerance
    assert "a drive makes positions jump ('sled' by 0.1)" in notes("branch(t - 1, 0, 0, 0.1)")


def test_a_drift_of_positions_at_a_kink_is_no_jump():
    """A step around a fast drive's kink changes its position by more than the tolerance."""
    scene = {
        "gravity": [0, 0],
        "bodies": {"arm": {"mass": 1, "inertia": 1}, "tip": {"mass": 1, "inertia": 1, "omega": -0.3}},
        "joints": {
            "shoulder": {"type": "revolute", "i": "arm", "j": "ground"},
            "elbow": {"type": "revolute", "i": "tip", "j": "arm"},
            "drive": {"type": "drive", "joint": "elbow", "position": "min(t, 1) + sin(7*t)"},
        },
    }
    solution = stiffmbs.run(
        stiffmbs.read_scene(json.dumps(scene)), formulation="index1", rtol=1e-8, duration=2, points=3
    )
    assert "velocities jump (arm.omega by 0.5" in str(solution.notes)
    assert "positions jump" not in str(solution.notes)


def test_no_missed_event_is_noted_where_none_is():
    """Long steps of a prescribed motion, a kink at an output time, and a sample within a step."""
    law = {"forces": {"f": {"type": "force", "i": "sled", "force": ["-1000*max(sled.x, 0)", 0]}}}
    ramp = {
        "gravity": [0, -9.81],
        "bodies": {
            "cart": {"mass": 3, "inertia": 1, "velocity": [0.75, 0]},
            "bob": {"mass": 1, "inertia": 0.01, "position": [0, -0.4], "velocity": [0.75, 0]},
        },
        "joints": {
            "rail": {"type": "prismatic", "i": "cart", "j": "ground"},
            "pin": {"type": "revolute", "i": {"body": "bob", "point": [0, 0.4]}, "j": "cart"},
            "motor": {"type": "drive", "joint": "rail", "position": "min(t*1.5/2, 1.5)"},
        },
    }
    sampled = {
        "bodies": {"m": {"mass": 1, "inertia": 1}},
        "joints": {"r": {"type": "prismatic", "i": "m", "j": "ground"}},
        "states": {"u": {"update": "branch(t - 0.55, 0, 0, 2)", "period": 0.1}},
        "forces": {"f": {"type": "force", "i": "m", "force": ["u - 1e4*max(m.x - 1, 0)", 0]}},
    }
    runs = [
        (sled("0.01*sin(20*t)", **law), {"solver": "radau", "points": 1001, "duration": 1.0}),
        (sled("0.01*sin(20*t)"), {"solver": "radau", "points": 1001, "duration": 1.0}),
        (stiffmbs.read_scene(json.dumps(ramp)), {**SOLVERS["dop853"], "duration": 4.0, "points": 401}),
        (stiffmbs.read_scene(json.dumps(sampled)), {"solver": "auto", "duration": 1.0, "output": 0.05, "rtol": 1e-8}),
    ]
    for scene, how in runs:
        notes = stiffmbs.run(scene, **how).notes
        assert not [note for note in notes if "missed" in note]
        assert len([note for note in notes if "jump" in note]) == ("motor" in scene.joints)


def test_breakpoints_of_straight_lines_are_exact():
    """Rounding of the ends of a run must not move them: laws are evaluated close to both sides."""
    for number in np.random.default_rng(0).uniform(0, 2, 50).tolist():
        inputs = inputs_of(stiffmbs.compile_model(sled(f"max(3*(t - {number!r}), 0)")))
        (t,) = breakpoint_times(inputs, 0.0, 2.7)
        assert abs(t - number) <= 4 * np.spacing(number)


ROADS = {
    "a hole": [[-100, 0], [2, 0], [2.05, -0.06], [2.6, -0.06], [2.65, 0], [100, 0]],
    "a crest": [[-100, 0], [2, 0], [2.3, 0.06], [2.6, 0], [100, 0]],
}


def quarter_car(road):
    """Return a wheel under a car at 10 m/s, with a light hub on a stiff bushing; the tyre's force jumps with the slope."""
    upright = [{"body": name, "angle": "90 deg"} for name in ("wheel", "hub", "car")]
    slopes = " + ".join(
        f"{(z_1 - z_0) / (x_1 - x_0)!r}*(branch(wheel.x - {x_0}, 0, 0, 1) - branch(wheel.x - {x_1}, 0, 0, 1))"
        for (x_0, z_0), (x_1, z_1) in itertools.pairwise(road)
    )
    tyre = f"max(0, 441*9.81 - 2e5*(wheel.y - road(wheel.x)) - 500*(wheel.vy - wheel.vx*({slopes})))"
    between = {
        "strut": ("car", "400*9.81 - 2e4*(car.y - wheel.y) - 1500*(car.vy - wheel.vy)"),
        "bush": ("hub", "9.81 - 1e8*(hub.y - wheel.y) - 1e3*(hub.vy - wheel.vy)"),
    }
    given = {
        "gravity": [0, -9.81],
        "tables": {"road": {"table": road, "lines": True}},
        "bodies": {
            name: {"mass": mass, "inertia": 1, "velocity": [10, 0]}
            for name, mass in (("car", 400), ("wheel", 40), ("hub", 1))
        },
        "joints": {f"rail_{k}": {"type": "prismatic", "i": upright[k], "j": upright[2]} for k in (0, 1)},
        "forces": {
            **{n: {"type": "force", "i": i, "j": "wheel", "force": [0, law]} for n, (i, law) in between.items()},
            "tyre": {"type": "force", "i": "wheel", "force": [0, tyre]},
        },
    }
    return stiffmbs.read_scene(json.dumps(given))


DURATIONS = (0.235, 0.28, 0.3)


@functools.cache
def velocities_of_the_wheel(road):
    """Return the vertical velocities of the wheel of `quarter_car` in runs of `DURATIONS`, from kink to kink by SciPy."""
    x, z = np.transpose(ROADS[road])
    times = np.unique(np.linspace(0, DURATIONS, 41))
    ends = np.unique([times[0], *(t for t in x / 10 if times[0] < t < times[-1]), times[-1]])
    state, found = np.zeros(6), [0.0]
    for begin, end in itertools.pairwise(ends):
        k = int(np.searchsorted(x, 10 * (begin + end) / 2)) - 1
        slope = (z[k + 1] - z[k]) / (x[k + 1] - x[k])

        def rates(t, s, k=k, slope=slope):
            car, wheel, hub, v_car, v_wheel, v_hub = s
            height = z[k] + slope * (10 * t - x[k])
            strut = 400 * 9.81 - 2e4 * (car - wheel) - 1500 * (v_car - v_wheel)
            bush = 9.81 - 1e8 * (hub - wheel) - 1e3 * (v_hub - v_wheel)
            tyre = max(0.0, 441 * 9.81 - 2e5 * (wheel - height) - 500 * (v_wheel - 10 * slope))
            of_wheel = (tyre - strut - bush) / 40 - 9.81
            return [v_car, v_wheel, v_hub, strut / 400 - 9.81, of_wheel, bush - 9.81]

        inside = times[(times > begin) & (times <= end)]
        run = solve_ivp(
            rates, (begin, end), state, "LSODA", np.unique([*inside, end]), rtol=1e-10, atol=1e-12, max_step=1e-3
        )
        found += run.y[4][np.isin(run.t, inside)].tolist()
        state = run.y[:, -1]
    return {duration: np.array(found)[np.isin(times, np.linspace(0, duration, 41))] for duration in DURATIONS}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("duration", DURATIONS)
@pytest.mark.parametrize("road", ROADS)
def test_a_state_at_the_edge_of_a_road_is_that_before_it(road, duration):
    """A step out of steady motion passes over the hole; forces beyond its edge must not move the state at the edge."""
    scene = quarter_car(ROADS[road])
    expected = velocities_of_the_wheel(road)[duration]
    for rtol in (1e-4, 1e-5, 1e-6):
        solution = stiffmbs.run(scene, duration=duration, points=41, solver="bdf", rtol=rtol)
        np.testing.assert_allclose(solution["wheel.vy"], expected, atol=30 * rtol + 2e-5)
