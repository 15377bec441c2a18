"""Errors that the steps of a run add up to: estimated in every run, and reported where they are large."""

import json
from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.run_checks.growth import accumulated_errors_sentence
from stiffmbs.show.summary import as_json
from stiffmbs.solve.bdf import integrated
from stiffmbs.solve.error_control.native.layouts import ACCUMULATED_ERRORS
from stiffmbs.solve.integrator import Integrator
from stiffmbs.solve.radau.radau import radau_integrator
from stiffmbs.solve.segments import Segment, joined
from stiffmbs.solve.solver import Traits
from stiffmbs.solve.trajectory import unwatched

from ..conftest import EXAMPLE_SCENES, EXAMPLES

SOLVERS = {
    "bdf": {"solver": "bdf"},
    "dop853": {"solver": "projected"},
    "dopri5": {"solver": "projected", "scheme": "dopri5"},
    "auto": {"solver": "auto"},
}
RATE = 100 * np.pi


def wheel(turns, more="", forces=""):
    """A wheel 0.1 m off its hinge, with 50 revolutions in a second, undamped."""
    return stiffmbs.read_scene(f"""
gravity: [0, 0]
bodies: {{w: {{mass: 1, inertia: 0.01, position: [0.1, 0], velocity: [0, {0.1 * RATE!r}], omega: {RATE!r}}}{more}}}
joints: {{h: {{type: revolute, i: {{body: w, point: [-0.1, 0]}}, j: ground}}}}
{forces}
run: {{duration: {turns / 50!r}, points: 2}}
""")


def driven(periods):
    """A mass of 1 kg under a force w sin(w t), which is displaced by 1 m."""
    rate = 2 * np.pi * periods
    return stiffmbs.read_scene(f"""
gravity: [0, 0]
bodies: {{b: {{mass: 1, inertia: 1}}}}
forces: {{f: {{type: force, i: b, force: ["{rate!r}*sin({rate!r}*t)", 0]}}}}
run: {{duration: 1, points: 2}}
""")


def oscillator(damping, force="0", duration=100):
    """A mass of 1 kg on a spring, 10 rad/s."""
    return stiffmbs.read_scene(f"""
gravity: [0, 0]
bodies: {{b: {{mass: 1, inertia: 1, position: [0.1, 0]}}}}
forces: {{s: {{type: force, i: b, force: ["-100*b.x - {damping}*b.vx + {force}", 0]}}}}
run: {{duration: {duration}, points: 101}}
""")


def noted(solution):
    return [note for note in solution.notes if "may accumulate" in note]


def estimated(scene, **how):
    """The estimated errors by the end, along velocities."""
    return prepare(scene, **how).integrate().displaced


def assert_near(estimate, error):
    assert abs(error) / 3 < estimate < 3 * abs(error)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_wheel_that_runs_ahead_is_reported(solver):
    turns = 1000 if solver == "auto" else 100
    solution = stiffmbs.run(wheel(turns), **SOLVERS[solver])
    error = solution["w.angle"][-1] - 2 * np.pi * turns
    assert abs(error) > 1e-4
    assert_near(estimated(wheel(turns), **SOLVERS[solver])[2], error)
    (note,) = noted(solution)
    assert "w.angle" in note and " rad, " in note and "rtol" in note and "--verify" in note and "\n" not in note
    assert note in json.loads(as_json("wheel", solution))["notes"]


@pytest.mark.parametrize("solver, periods", [("bdf", 300), ("dopri5", 1000)])
def test_a_mass_driven_over_many_periods_is_reported(solver, periods):
    solution = stiffmbs.run(driven(periods), **SOLVERS[solver])
    error = solution["b.x"][-1] - 1
    assert abs(error) > 2e-4
    assert_near(estimated(driven(periods), **SOLVERS[solver])[0], error)
    (note,) = noted(solution)
    assert "b.x" in note and " m, " in note


@pytest.mark.parametrize("solver, periods", [("bdf", 300), ("dopri5", 3000)])
@pytest.mark.parametrize("held", ["", "joints: {h: {type: prismatic, i: w, j: {body: ground, point: [0, 1]}}}"])
def test_a_fast_body_does_not_hide_the_errors_of_a_slow_one(solver, periods, held):
    """A heavy body moves uniformly; the force on the other one depends on its position."""
    rate = 2 * np.pi * periods
    scene = stiffmbs.read_scene(f"""
gravity: [0, 0]
bodies:
  b: {{mass: 1, inertia: 1}}
  w: {{mass: 1e6, inertia: 1, position: [0, 1], velocity: [10, 0]}}
{held}
forces: {{f: {{type: force, i: b, force: ["{rate!r}*sin({rate / 10!r}*w.x)", 0]}}}}
run: {{duration: 1, points: 2}}
""")
    solution = stiffmbs.run(scene, **SOLVERS[solver])
    error = solution["b.x"][-1] - 1
    assert abs(error) > 2e-4
    displaced = estimated(scene, **SOLVERS[solver])
    assert_near(displaced[0], error)
    (note,) = noted(solution)
    assert "b.x" in note


def test_velocities_are_grouped_by_the_constraints_that_connect_them():
    """The bodies of a chain have one group; a free body has one for its velocity and one for its angular velocity."""
    scene = stiffmbs.read_scene("""
gravity: [0, 0]
bodies: {d: {mass: 1, inertia: 1}, a: {mass: 1, inertia: 1}, c: {mass: 1, inertia: 1}, b: {mass: 1, inertia: 1}}
joints:
  one: {type: revolute, i: {body: a, point: [1, 0]}, j: {body: b, point: [-1, 0]}}
  two: {type: revolute, i: {body: b, point: [1, 0]}, j: {body: c, point: [-1, 0]}}
run: {duration: 1}
""")
    groups = prepare(scene, presolve=False).dynamics.system.velocity_groups.reshape(4, 3)
    assert len(np.unique(groups)) == 3
    assert groups[0, 0] == groups[0, 1] != groups[0, 2]
    assert len(np.unique(groups[1:])) == 1 and groups[1, 0] not in groups[0]


@pytest.mark.long
def test_the_published_settings_are_reported():
    for scene, channel, value in ((wheel(1000), "w.angle", 2000 * np.pi), (driven(10_000), "b.x", 1.0)):
        solution = stiffmbs.run(scene, solver="bdf", rtol=1e-6)
        number = {"w.angle": 2, "b.x": 0}[channel]
        assert_near(estimated(scene, solver="bdf", rtol=1e-6)[number], solution[channel][-1] - value)
        assert noted(solution)


def test_a_tight_tolerance_is_not_reported():
    assert not noted(stiffmbs.run(wheel(100), solver="projected", rtol=1e-10))


@pytest.mark.parametrize("solver", ["bdf", "dop853", "dopri5"])
@pytest.mark.parametrize(
    "scene",
    [oscillator(1), oscillator(100, duration=1000), oscillator(2, "10*sin(7*t)", 500)],
    ids=["damped", "overdamped", "forced"],
)
def test_what_damping_forgets_is_not_reported(scene, solver):
    """Errors of the speed do not add up where forces damp the motion: some 1e-7 m are left, and estimates from one of 251 steps are rougher."""
    assert np.max(estimated(scene, **SOLVERS[solver])) < 4e-5
    assert not noted(stiffmbs.run(scene, **SOLVERS[solver]))


def test_a_half_car_is_not_reported():
    scene = stiffmbs.load_scene(EXAMPLES / "half_car.yaml")
    for how in SOLVERS.values():
        assert not noted(stiffmbs.run(scene, **how))


@pytest.mark.long
def test_no_example_is_reported():
    for path in EXAMPLE_SCENES.values():
        assert not noted(stiffmbs.run(path)), path.name


@pytest.mark.parametrize("solver", ["bdf", "dop853"])
def test_estimates_go_on_over_events_and_breakpoints(solver):
    """A law that begins and ends in each turn has the solver start again."""
    scene = wheel(100, forces="forces: {f: {type: torque, i: w, torque: '1e-9*max(sin(157*t), 0)'}}")
    solution = stiffmbs.run(scene, **SOLVERS[solver], max_step=1e-3)
    assert solution.solver["breakpoints"] + solution.solver["events"] > 50
    error = solution["w.angle"][-1] - 200 * np.pi
    assert_near(estimated(scene, **SOLVERS[solver], max_step=1e-3)[2], error)


@pytest.mark.parametrize("make", [Integrator, radau_integrator])
def test_a_step_that_an_event_ends_counts_up_to_the_event(make):
    """A ball bounces within the steps; their parts after the events are no part of the motion."""
    job = prepare(EXAMPLES / "bouncing_ball.yaml", rtol=1e-6)
    integrator = make(job.dynamics, job.settings)
    found = integrated(integrator, job.start, job.grid, unwatched)
    assert found.statistics["events"] > 5
    sums = integrator.engine.ida.error_sums.table.view(ACCUMULATED_ERRORS.cells)[0]
    np.testing.assert_allclose(sums["time"] + sums["span"], found.t[-1], rtol=1e-9)


def test_estimates_of_what_the_presolve_takes_apart():
    """The second wheel, which carries a body, is solved by itself."""
    more = (
        f", v: {{mass: 1, inertia: 0.01, position: [5.1, 0], velocity: [0, {0.1 * RATE!r}], omega: {RATE!r}}}"
        f", c: {{mass: 1, inertia: 0.01, position: [5.2, 0], velocity: [0, {0.2 * RATE!r}], omega: {RATE!r}}}"
    )
    scene = stiffmbs.read_scene(f"""
gravity: [0, 0]
bodies: {{w: {{mass: 1, inertia: 1}}{more}}}
joints:
  h: {{type: revolute, i: {{body: v, point: [-0.1, 0]}}, j: {{body: ground, point: [5, 0]}}}}
  f: {{type: fixed, i: v, j: c}}
run: {{duration: 2, points: 2}}
""")
    job = prepare(scene, solver="bdf")
    assert job.subsystems
    found = job.integrate().displaced
    assert found[0] == found[1] == found[2] == 0.0
    assert found[5] == found[8] > 1e-3
    (note,) = noted(stiffmbs.run(scene, solver="bdf"))
    assert "v.angle" in note or "c.angle" in note


def test_a_rotation_in_space_is_named_by_its_axis():
    scene = stiffmbs.read_scene(f"""
dimensions: 3
gravity: [0, 0, 0]
bodies: {{w: {{mass: 1, inertia: [0.01, 0.01, 0.02], position: [0.1, 0, 0], velocity: [0, {0.1 * RATE!r}, 0], omega: [0, 0, {RATE!r}]}}}}
joints: {{h: {{type: revolute, i: {{body: w, point: [-0.1, 0, 0]}}, j: ground}}}}
run: {{duration: 2, points: 2}}
""")
    (note,) = noted(stiffmbs.run(scene, solver="bdf"))
    assert "the rotation of 'w' about its z axis" in note


def test_segments_of_both_integrators_count():
    one = prepare(wheel(10), solver="bdf").integrate()
    two = replace(one, displaced=2 * one.displaced)
    explicit, implicit = Traits("projected"), Traits("bdf", implicit=True)
    assert np.array_equal(joined([Segment(one, explicit), Segment(two, implicit)]).displaced, 3 * one.displaced)
    unknown = replace(one, displaced=None)
    assert joined([Segment(unknown, explicit)]).displaced is None


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
@pytest.mark.parametrize("at", ["rest", "distance"])
def test_a_hundred_tolerances_are_reported_and_no_tighter_one_than_usual(rtol, at):
    """Positions of 1 m have twice the tolerance at a distance of 1 m; angles have the same in all turns."""
    job = prepare(wheel(1, ", b: {mass: 1, inertia: 1, position: [3, 0]}"), solver="bdf", rtol=rtol)
    trajectory = job.integrate()
    system, settings = job.dynamics.system, job.settings
    size = min(1.0, system.size)
    assert size == 1.0
    number, factor = (2, 1.0) if at == "rest" else (3, 4.0)
    for part, expected in ((0.8, 0), (1.2, 1)):
        displaced = np.zeros(6)
        displaced[number] = 100 * 1e-6 * factor * part
        found = [*accumulated_errors_sentence(system, settings, replace(trajectory, displaced=displaced))]
        assert len(found) == expected, (part, found)


def test_explicit_estimates_cost_less_than_a_hundredth():
    """Accelerations: 12 a step of dop853, and as many for each half of the steps that are measured."""
    statistics = stiffmbs.run(wheel(1000), solver="projected").solver
    tried = statistics["steps"] + statistics["rejected"]
    assert 12 * tried < statistics["accelerations"] < 1.01 * 12 * tried


@pytest.mark.parametrize("rtol, noted", [(1e-6, True), (1e-9, False)])
def test_a_satellite_of_two_bodies_has_errors_relative_to_its_size(rtol, noted):
    """At 7000 km from the origin rtol 1e-6 allows 7 m, and the tether of two bodies is 100 m long."""
    pull = '["-3.986e15*{0}.x/({0}.x^2 + {0}.y^2)^1.5", "-3.986e15*{0}.y/({0}.x^2 + {0}.y^2)^1.5"]'
    rate = np.sqrt(3.986e14 / 7e6**3)
    scene = f"""
bodies:
  p: {{mass: 10, inertia: 1, position: [7000050, 0], velocity: [0, {rate * 7000050}]}}
  q: {{mass: 10, inertia: 1, position: [6999950, 0], velocity: [0, {rate * 6999950}]}}
joints: {{tether: {{type: distance, i: p, j: q, length: 100}}}}
forces: {{f: {{type: force, i: p, force: {pull.format("p")}}}, g: {{type: force, i: q, force: {pull.format("q")}}}}}
run: {{duration: {2 * np.pi / rate}, points: 101, rtol: {rtol}}}
"""
    solution = stiffmbs.run(stiffmbs.read_scene(scene))
    found = [note for note in solution.notes if "of the size of its mechanism" in note]
    assert bool(found) is noted
