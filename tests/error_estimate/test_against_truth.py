"""Estimated errors against the truth: closed forms, minimal equations, and steady or prescribed motions without errors."""

import contextlib
import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs.analyses.load_scene import load_scene
from tests.conftest import EXAMPLES
from tests.solve.test_stiff_reactions import KINKS
from tests.solve.test_stiff_reactions import pendulum as pushed
from tests.stress.self_assessment import assess, drawn, table

G = 9.81
PENDULUM = """
gravity: [0, -9.81]
bodies: {{bob: {{mass: 1, inertia: 0.1, position: [1, 0], angle: 0}}}}
joints: {{pin: {{type: revolute, i: {{body: bob, point: [-1, 0]}}, j: ground}}}}
run: {{duration: {duration}, points: 101}}
"""
BUSHING = """
bodies:
  base: {mass: 100, inertia: 10}
  tool: {mass: 2, inertia: 0.1, position: [0.1, 0], velocity: [0.1, 0]}
joints: {rail: {type: prismatic, i: base, j: ground}, guide: {type: prismatic, i: tool, j: ground}}
forces:
  soft: {type: spring_damper, i: base, j: {body: ground, point: [-1, 0]}, stiffness: 1e4, damping: 10, free_length: 1}
  mount: {type: force, i: tool, j: base, force: ["-1e7*(tool.x - base.x - 0.1) - 200*(tool.vx - base.vx)", 0]}
run: {duration: 0.5, points: 1001}
"""
CONICAL = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies: {b: {mass: 1, inertia: [1e-3, 1e-3, 1e-3], position: [0.2823212366975177, 0, -0.41266780745483916], velocity: [0, 1.376504882501672, 0]}}
joints: {d: {type: distance, i: b, j: ground, length: 0.5}}
run: {duration: 20, points: 101}
"""
CRANK = """
bodies: {crank: {mass: 1, inertia: 0.1}, rod: {mass: 1, inertia: 0.1, position: [0.35, 0]}, slider: {mass: 1, inertia: 1, position: [0.6, 0]}}
joints:
  pin: {type: revolute, i: crank, j: ground}
  big: {type: revolute, i: {body: crank, point: [0.1, 0]}, j: {body: rod, point: [-0.25, 0]}}
  small: {type: revolute, i: {body: rod, point: [0.25, 0]}, j: slider}
  guide: {type: prismatic, i: slider, j: ground}
  motor: {type: drive, joint: pin, position: 20*t}
run: {duration: 20, points: 201}
"""


def solved(scene, **how):
    return stiffmbs.run(stiffmbs.read_scene(scene), errors=True, **how)


def ratio(found, channel, truth):
    """Return the estimated error of a channel in its true one, both the largest over time."""
    return found.errors[channel].over_time / np.abs(found[channel] - truth).max()


def pendulum(t):
    """Return the angle of a pendulum of 1 m from the horizontal, and its rate, by its minimal equation."""
    inertia = 1.1
    made = solve_ivp(
        lambda _, y: [y[1], -G * np.cos(y[0]) / inertia], (0, t[-1]), [0, 0], "DOP853", t, rtol=1e-13, atol=1e-13
    )
    return made.y


@pytest.mark.parametrize("solver, rtol", [("bdf", 1e-4), ("bdf", 1e-6), ("bdf", 1e-8), ("radau", 1e-5)])
def test_a_pendulum(solver, rtol):
    found = solved(PENDULUM.format(duration=8), solver=solver, rtol=rtol)
    angle, rate = pendulum(found.time)
    acceleration_y = np.cos(angle) * (-G * np.cos(angle) / 1.1) - np.sin(angle) * rate**2
    assert 0.7 < ratio(found, "bob.angle", angle) < 1.5
    assert 0.7 < ratio(found, "bob.omega", rate) < 1.5
    assert 0.7 < ratio(found, "pin.fy", acceleration_y + G) < 1.5


@pytest.mark.parametrize("solver, rtol", [("bdf", 1e-4), ("bdf", 1e-6), ("radau", 1e-4)])
def test_the_force_of_a_stiff_mount(solver, rtol):
    """Its vibration takes some ten steps of bdf in a period, which blocks of eight steps would damp."""
    found = solved(BUSHING, solver=solver, rtol=rtol)
    c, d, k, r = 1e4, 10.0, 1e7, 200.0
    a = np.array(
        [[0, 0, 1, 0], [0, 0, 0, 1], [-(c + k) / 100, k / 100, -(d + r) / 100, r / 100], [k / 2, -k / 2, r / 2, -r / 2]]
    )
    rates, modes = np.linalg.eig(a)
    start = np.linalg.solve(modes, np.array([0, 0, 0, 0.1]))
    y = (modes @ (start[:, None] * np.exp(rates[:, None] * found.time))).real
    force = -k * (y[1] - y[0]) - r * (y[3] - y[2])
    assert 0.6 < ratio(found, "mount.fx", force) < 1.6
    assert 0.5 < ratio(found, "base.x", y[0]) < 2


def test_a_drift_that_local_errors_do_not_show():
    """A conical pendulum: the sum of local errors was a hundredth of the error of 0.13 mm."""
    found = solved(CONICAL, solver="bdf")
    angle = found.time * 1.376504882501672 / 0.2823212366975177
    assert 0.9 < ratio(found, "b.x", 0.2823212366975177 * np.cos(angle)) < 1.1
    assert any("the estimated error of b." in note for note in found.notes)


@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_a_prescribed_motion_has_no_error(solver):
    found = solved(CRANK, solver=solver, rtol=1e-4)
    assert found.estimate.status == "estimated" and not any("estimated error" in note for note in found.notes)
    assert found.errors["slider.x"].over_time < 1e-9
    assert "positions to 12 digits" in found.estimate.sentence or found.estimate.relative < 1e-9


@pytest.mark.long
def test_forces_of_rounding_have_no_note():
    """A free body on an axis: the forces of the joint are 1e-60 N."""
    found = solved(
        """
        dimensions: 3
        bodies: {b: {mass: 1, inertia: [1, 1, 1], velocity: [0, 0, 1], omega: [0, 0, 2]}}
        joints: {c: {type: cylindrical, i: b, j: ground}}
        run: {duration: 1, points: 11, solver: radau, rtol: 1e-5}
        """
    )
    assert found.estimate.status == "estimated" and not any("estimated error" in note for note in found.notes)


def test_a_lost_solution_is_reported():
    """An inverted pendulum on a cart; its error grows by a factor of 1e20 in 10 s."""
    found = solved(
        """
        gravity: [0, -9.81]
        bodies:
          cart: {mass: 2, inertia: 1}
          bar: {mass: 1, inertia: 1/12, position: [0.5*sin(0.02), 0.5*cos(0.02)], angle: -0.02}
        joints:
          rail: {type: prismatic, i: cart, j: ground}
          hinge: {type: revolute, i: {body: bar, point: [0, -0.5]}, j: cart}
        run: {duration: 10, points: 101, rtol: 1e-4}
        """
    )
    assert found.estimate.status == "lost" and any("lost from t = " in note for note in found.notes)
    assert all(np.isnan(bar.over_time) for bar in found.errors.values())


@pytest.mark.long
def test_an_impact_shifts_the_time_of_the_next_ones():
    """A ball on a stiff floor, against a run with a much smaller tolerance."""
    found, fine = (
        stiffmbs.run(
            stiffmbs.read_scene(
                """
                gravity: [0, -9.81]
                bodies: {ball: {mass: 1, inertia: 1, position: [0, 1]}}
                forces: {floor: {type: force, i: ball, force: [0, "1e5*max(0, -ball.y)"]}}
                run: {duration: 2, points: 201}
                """
            ),
            errors=True,
            **how,
        )
        for how in ({"solver": "bdf"}, {"solver": "radau", "rtol": 1e-11})
    )
    assert found.solver["events"] > 3
    assert 0.5 < ratio(found, "ball.y", fine["ball.y"]) < 2


def test_the_errors_of_separate_mechanisms_are_their_own():
    """Two pendulums of which one is much longer: they are solved apart, with steps of their own."""
    scene = """
        gravity: [0, -9.81]
        bodies:
          a: {mass: 1, inertia: 0.1, position: [1, 0]}
          b: {mass: 1, inertia: 0.1, position: [5, 0]}
          far: {mass: 1, inertia: 0.1, position: [0, 3], velocity: [1, 0]}
        joints:
          p: {type: revolute, i: {body: a, point: [-1, 0]}, j: ground}
          r: {type: revolute, i: {body: b, point: [-5, 0]}, j: ground}
        forces: {push: {type: force, i: b, force: ["step(t, 1, 0, 2, 1)", 0]}}
        run: {duration: 8, points: 101, solver: bdf}
        """
    found = solved(scene)
    angle, _ = pendulum(found.time)
    assert 0.7 < ratio(found, "a.angle", angle) < 1.5
    assert found.errors["far.x"].over_time < 1e-9


def test_a_run_of_much_work_says_how_to_ask():
    found = stiffmbs.run(stiffmbs.read_scene(PENDULUM.format(duration=8)), tuning={"error_estimate": {"work": 100}})
    assert not found.errors and "--errors" in found.estimate.sentence


@pytest.mark.long
def test_a_run_of_many_restarts_says_how_to_ask():
    """The estimate of a relay with 21 249 switches took 54 s, the run 14 s."""
    relay = """
    gravity: [0, 0]
    bodies: {block: {mass: 1, inertia: 1, velocity: [1, 0]}}
    forces: {push: {type: force, i: block, force: ["-3*sign(sin(1000*t))*sign(block.vx + 1)", 0]}}
    run: {duration: 2, points: 3, solver: bdf}
    """
    found = stiffmbs.run(stiffmbs.read_scene(relay))
    assert found.solver["breakpoints"] + found.solver["events"] > 500 and found.solver["steps"] < 20000
    assert not found.errors and "--errors" in found.estimate.sentence
    assert stiffmbs.run(stiffmbs.read_scene(relay), errors=True).errors


@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-8])
@pytest.mark.parametrize(
    "how", [{"solver": "dop853"}, {"solver": "dopri5"}, {"solver": "auto"}], ids=lambda how: how["solver"]
)
def test_explicit_steps_take_a_second_run(how, rtol):
    """A ninth of the difference from a run at ten times the tolerance was 0.05 to 18 times the error."""
    how = {"solver": "projected", "scheme": how["solver"]} if how["solver"] != "auto" else how
    found = stiffmbs.run(stiffmbs.read_scene(PENDULUM.format(duration=8)), rtol=rtol, **how)
    angle, rate = pendulum(found.time)
    assert 1 / 2 < ratio(found, "bob.angle", angle) < 2
    assert 1 / 2 < ratio(found, "bob.omega", rate) < 2


@pytest.mark.parametrize(
    "limit", [{"atol": 1e-6, "rtol": 1e-9}, {"max_step": 0.1, "rtol": 1e-4}], ids=["atol", "max_step"]
)
def test_second_runs_are_better_in_what_limits_the_steps(limit):
    found = stiffmbs.run(stiffmbs.read_scene(PENDULUM.format(duration=8)), solver="projected", **limit)
    assert 1 / 2 < ratio(found, "bob.angle", pendulum(found.time)[0]) < 2


def test_steps_that_breakpoints_limit_need_a_smaller_tolerance():
    """Both runs took the same 8 steps; their difference was a tenth of the error."""
    found, truth = (stiffmbs.run(pushed(f"solver: projected, rtol: {rtol}", None, KINKS)) for rtol in (1e-3, 1e-11))
    assert 1 / 2 < ratio(found, "first.angle", truth["first.angle"]) < 2


def test_a_long_step_of_both_runs():
    """The first of four steps was that of the second run, and most of the error: the estimate was a hundredth of it."""
    scene, how = drawn(51223, "projected")
    ratios = assess(scene, {**how, "rtol": 1e-3}).ratios()
    assert len(ratios) == 3 and all(1 / 2 < each < 2 for each in ratios.values())


def test_peaks_of_explicit_runs_are_those_between_outputs():
    """A mass on a spring with three output times, which miss its amplitude of 0.1 m."""
    scene = """
        bodies: {b: {mass: 1, inertia: 1, position: [0, 0], velocity: [1, 0]}}
        forces: {s: {type: force, i: b, force: [-100*b.x, 0]}}
        run: {duration: 1, points: 3, solver: projected}
        """
    found = solved(scene)
    beyond = 0.1 - found["b.x"].max()
    assert 0.01 < beyond < found.errors["b.x"].greatest < 3 * beyond


def test_long_explicit_runs_take_no_second_run():
    found = stiffmbs.run(
        stiffmbs.read_scene(PENDULUM.format(duration=8)), solver="projected", tuning={"error_estimate": {"work": 100}}
    )
    assert not found.errors and "--errors" in found.estimate.sentence


@pytest.mark.sampled(2)
@pytest.mark.long(200)
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_random_scenes(solver, every):
    found, seeds = [], every(range(24), 4)
    for seed in seeds:
        with contextlib.suppress(stiffmbs.AssemblyError):  # some draw more equations than freedoms
            found.append(assess(*drawn(seed, solver)))
    assert len(found) > 0.8 * len(seeds)
    print(table(found))
    for group, least in (("positions", 0.85), ("forces", 0.65)):
        ratios = np.array([one.ratios()[group] for one in found if group in one.ratios()])
        assert np.mean((ratios > 1 / 3) & (ratios < 3)) > least
    assert not any(one.is_false or one.is_silent for one in found)


def test_motions_below_the_tolerance_have_no_note():
    """A mass at rest on a spring but for 1 nm: its velocity is wrong by all its size, which is far below the tolerance."""
    found = solved(
        """
        gravity: [0, -9.81]
        bodies: {b: {mass: 1, inertia: 1, position: [0, 1]}}
        joints: {rail: {type: prismatic, i: {body: b, angle: 90 deg}, j: {body: ground, angle: 90 deg}}}
        forces: {s: {type: spring_damper, i: b, j: ground, stiffness: 9810, damping: 100, free_length: 1.001000001}}
        run: {duration: 1, points: 11}
        """
    )
    assert np.abs(found["b.vy"]).max() < 1e-6 and not any("estimated error" in note for note in found.notes)
    assert found.estimate.relative < 0.01


@functools.cache
def hundred_impacts():
    """Return a run of the ball of the examples at a tolerance near rounding."""
    scene = load_scene(EXAMPLES / "bouncing_ball.yaml")
    return stiffmbs.run(scene, solver="projected", rtol=1e-12, duration=20, points=2001, output=None)


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_a_ball_after_a_hundred_impacts(solver):
    """The errors of the times of its impacts were turned into energy, which grew by 15 % with each one."""
    scene = load_scene(EXAMPLES / "bouncing_ball.yaml")
    found = stiffmbs.run(scene, solver=solver, duration=20, points=2001, output=None, errors=True)
    truth = hundred_impacts()
    assert 1 / 3 < ratio(found, "ball.y", truth["ball.y"]) < 3
    assert 1 / 3 < ratio(found, "ball.vy", truth["ball.vy"]) < 3


@pytest.mark.long
def test_a_passage_of_a_singular_pose_is_not_lost():
    """Parallel cranks pass collinear poses, where rows of the constraints are dependent; the error is 2e-7 rad."""
    found = stiffmbs.run(load_scene(EXAMPLES / "four_bars.yaml"), solver="radau", duration=3, errors=True)
    assert found.estimate.status == "none" and "more than one motion may follow" in found.estimate.sentence
    assert any("passes a singular pose" in note for note in found.notes) and not any(
        "lost" in note for note in found.notes
    )


@pytest.mark.long
def test_stiff_beams_that_turn_are_not_lost():
    """A mean of the matrices of two tangent spaces was not stable: the error of a leaf spring grew without bounds."""
    scene = load_scene(EXAMPLES / "beams" / "leaf_spring.yaml")
    found = stiffmbs.run(scene, solver="bdf", duration=3.5, errors=True)
    exact = stiffmbs.run(scene, solver="radau", rtol=1e-9, duration=3.5, errors=False)
    for channel in ("frame.y", "leaf.node1.angle", "clamp.torque"):
        assert 0.3 < ratio(found, channel, exact[channel]) < 3.0


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_beyond_a_pose_with_several_motions_there_is_no_estimate(solver):
    """The mechanism becomes collinear, where its motion branches: positions had 5 digits, and those of another branch were right."""
    found = stiffmbs.run(load_scene(EXAMPLES / "four_bars.yaml"), solver=solver, errors=True)
    assert any("more than one motion may follow" in note for note in found.notes)
    assert found.estimate.status == "none"
    assert "more than one motion may follow" in found.estimate.sentence


def test_a_run_of_one_explicit_step_is_compared_with_shorter_ones():
    """The second run took the same step: all errors were zero."""
    scene = stiffmbs.read_scene("""
        gravity: [0, -9.81]
        bodies: {p: {mass: 1, inertia: 0.01, position: [0.3, 0]}, q: {mass: 1, inertia: 0.01, position: [0.9, 0]}}
        joints:
          h: {type: revolute, i: {body: p, point: [-0.3, 0]}, j: ground}
          g: {type: revolute, i: {body: q, point: [-0.3, 0]}, j: {body: p, point: [0.3, 0]}}
        forces:
          c: {type: spring_damper, i: q, j: {body: ground, point: [0.9, 0.5]}, stiffness: 1e6, damping: 100, free_length: 0.5}
        run: {duration: 1e-3, points: 11}
    """)
    found = stiffmbs.run(scene, solver="projected", rtol=1e-3, errors=True)
    truth = stiffmbs.run(scene, solver="projected", rtol=1e-12, max_step=1e-4, errors=False)
    assert found.solver["steps"] == 1
    for name in ("q.alpha", "q.omega"):
        assert 0.5 < ratio(found, name, truth[name]) < 2.0, name


def test_a_peak_beside_values_that_are_none_has_no_bar():
    """The error of a root is unknown beside the edge of its range: its least value had that of rounding."""
    scene = stiffmbs.read_scene("""
        gravity: [0, -9.81]
        bodies: {p: {mass: 1, inertia: 0.01, position: [0.3, 0]}}
        joints: {h: {type: revolute, i: {body: p, point: [-0.3, 0]}, j: ground}}
        requests: {half: sqrt(p.x)}
        run: {duration: 2, points: 101, rtol: 1e-3}
    """)
    found = stiffmbs.run(scene, solver="bdf", errors=True)
    truth = stiffmbs.run(scene, solver="radau", rtol=1e-10, errors=False)
    error = np.abs(found["half"] - truth["half"])[np.nanargmin(found["half"])]
    assert not found.errors["half"].least < 0.2 * error
    assert np.isfinite(found.errors["half"].greatest)


@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_matrices_may_be_in_memory_one_by_one(solver):
    """The estimate of a car failed with an index of an empty group of blocks, where each block filled the memory allowed."""
    found, by_one = (
        solved(PENDULUM.format(duration=2), solver=solver, tuning={"error_estimate": tuning})
        for tuning in ({}, {"numbers_at_once": 1})
    )
    for name, bar in by_one.errors.items():
        for field in (
            "over_time",
            "least",
            "greatest",
        ):  # peaks do not depend on the blocks of times in which they are searched
            assert np.isclose(getattr(bar, field), getattr(found.errors[name], field), rtol=1e-6, atol=1e-12), (
                name,
                field,
            )


@pytest.mark.parametrize("scheme, step", [("euler_cromer", 1e-3), ("rk4", 6e-3)])
def test_fixed_steps_are_compared_with_half_of_them(scheme, step):
    """The step, reduced to divide the output interval, is halved: a half of the given one could be the same."""
    scene = stiffmbs.read_scene("""
        gravity: [0, -9.81]
        bodies: {a: {mass: 1, inertia: 0.1, position: [1, 0]}, b: {mass: 1, inertia: 0.1, position: [3, 0]}}
        joints:
          p: {type: revolute, i: {body: a, point: [-1, 0]}, j: ground}
          q: {type: revolute, i: {body: b, point: [-1, 0]}, j: {body: a, point: [1, 0]}}
        run: {duration: 1, output: 10 ms}
    """)
    truth = stiffmbs.run(scene, solver="radau", rtol=1e-12, errors=False)
    for given in (step, 0.05):
        found = stiffmbs.run(scene, solver="projected", scheme=scheme, step=given)
        for name in ("a.x", "b.y", "b.omega", "p.fy"):
            assert 0.8 < ratio(found, name, truth[name]) < 1.25, (name, given)


def test_fixed_steps_over_jumps_of_forces_are_not_estimated():
    """Steps of both lengths met a jump at the same times: their results agreed to 12 digits, and the error was 4 %."""
    scene = stiffmbs.read_scene("""
        bodies: {b: {mass: 1, inertia: 1, position: [0.2, 0]}}
        joints: {r: {type: prismatic, i: b, j: ground}}
        forces: {f: {type: force, i: b, force: ["-5*sign(b.x) + 1", 0]}}
        run: {duration: 4, points: 41}
    """)
    found = stiffmbs.run(scene, solver="projected", scheme="euler_cromer", step=1e-3, errors=True)
    assert found.estimate.status == "none" and "does not locate breakpoints" in found.estimate.sentence


def test_states_of_one_of_two_mechanisms_have_no_errors_by_the_other():
    """The bars of a controller's states were their own sizes, as the second mechanism has them at their start."""
    text = """
gravity: [0, -9.81]
bodies:
  bar: {mass: 1, inertia: 0.1, position: [0.5, 0]}
  other: {mass: 2, inertia: 0.1, position: [3, 0], velocity: [0.1, 2]}
joints: {hinge: {type: revolute, i: {body: bar, point: [-0.5, 0]}, j: ground}}
states: {control: {pid: {input: bar.x, setpoint: -0.2, kp: 10, ki: 5, kd: 2, filter: 0.05}}}
forces: {motor: {type: torque, i: bar, torque: control}, push: {type: force, i: other, force: ['sin(3*t)', 0]}}
run: {duration: 0.4, points: 41}
"""
    scene = stiffmbs.read_scene(text)
    found = stiffmbs.run(scene, solver="bdf", rtol=1e-5, errors=True)
    assert any("2 independent mechanisms" in words for words in found.presolve)
    exact = stiffmbs.run(scene, solver="radau", rtol=1e-11, errors=False)
    for channel in ("control.integral", "control.filtered", "control", "motor.torque", "hinge.fx"):
        error = np.abs(found[channel] - exact[channel]).max()
        assert found.errors[channel].over_time == pytest.approx(error, rel=0.2), channel
