"""Events that begin and end within one step, and laws with zones: what is found, and what costs nothing."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.compile.compile_model import compile_model
from stiffmbs.compile.law_intervals import intervals_of
from tests.stress.case import Outcome
from tests.stress.families.events import within_one_step
from tests.stress.fuzzers import contacts


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize("case", within_one_step.CASES, ids=lambda case: case.name)
def test_what_begins_and_ends_within_one_step_is_seen(case):
    verdict = case.judge()
    assert verdict.outcome is Outcome.RIGHT, verdict


@pytest.mark.sampled(12)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(20))
def test_random_contacts_and_bumps(seed):
    verdict = contacts.trial(seed)
    assert verdict.outcome in (Outcome.RIGHT, Outcome.TOLD), verdict


def pushed(table, law="p(b.x)", velocity=1.0):
    return stiffmbs.read_scene(f"""
gravity: [0, 0]
tables: {{p: {table}}}
bodies: {{b: {{mass: 1, inertia: 1, velocity: [{velocity}, 0]}}}}
forces: {{f: {{type: force, i: b, force: ["{law}", 0]}}}}
""")


def breakpoints(table):
    intervals = intervals_of(compile_model(pushed(table)))
    assert intervals.first.tolist() == [0, len(intervals.breakpoints)] and len(intervals.overlap) == len(
        intervals.breakpoints
    )
    return intervals.breakpoints, intervals.period[0]


def test_a_smooth_table_has_few_zones_and_a_bump_one_of_its_own():
    x = np.linspace(0, 2 * np.pi, 361)
    smooth, _ = breakpoints(f"{{table: {np.column_stack([x, np.cos(x)]).tolist()}}}")
    assert len(smooth) < 15
    bump, _ = breakpoints("{table: [[0, 0], [15, 0], [15.05, -1000], [15.1, 0], [30, 0]], lines: true}")
    assert bump.tolist() == [0, 15, 15.05, 15.1, 30]


def test_zones_follow_numbers_that_change_in_place():
    system = compile_model(pushed("{table: [[0, 0], [1, 1], [2, 0]], lines: true}"))
    before = intervals_of(system)
    assert intervals_of(system) is before
    (group,) = system.groups
    group.numbers[group.numbers == 1.0] = 1.5
    assert before.breakpoints.tolist() == [0, 1, 2] and intervals_of(system).breakpoints.tolist() != [0, 1, 2]


def test_a_reciprocal_has_no_edge_where_its_usual_arguments_turn_round():
    """1/(1 + x^2) and 1/cos(x) have their extremum at 1: whether it passes an edge there is left to rounding."""
    found = intervals_of(compile_model(pushed("{table: [[0, 0], [1, 1]]}", "1/(1 + b.x^2)"))).breakpoints
    assert np.abs(np.abs(found) - 1).min() > 0.4


DAMPER = "{akima: true, table: [[-2, -1380], [-1, -780], [-0.4, -420], [-0.2, -300], [-0.1, -150], [0, 0], [0.1, 250], [0.2, 500], [0.4, 700], [2, 2300]]}"
STOP = "{lines: true, table: [[-1, 0], [0, 0], [0.01, 1e6]]}"


def overlap_at_zero(table, law="p(b.x)"):
    intervals = intervals_of(compile_model(pushed(table, law)))
    return intervals.overlap[np.flatnonzero(intervals.breakpoints == 0)[0]]


def test_zones_overlap_where_the_law_goes_on_smoothly():
    """At 0.1 mm/s a damper is straight over its knot, to a thousandth; a stop is another law from its first nanometres on."""
    assert 1e-4 < overlap_at_zero(DAMPER) < 0.1
    assert 0 < overlap_at_zero(STOP) <= 1e-8
    assert overlap_at_zero("{table: [[-1, -1], [0, 0], [1, 1], [2, 0]], lines: true}") == pytest.approx(1)


def test_a_damper_that_hardly_moves_stops_no_step_at_the_knots_of_its_table():
    """A body swings ever slower in a soft damper and a stiff spring: no step ends at a knot of the damper's table."""
    scene = pushed(DAMPER, "-1e4*b.x - p(b.vx)/1e3", 1e-4)
    solution = stiffmbs.run(scene, duration=10.0, points=2, rtol=1e-4, solver="projected")
    assert_no_step_is_taken_again(solution.solver)


def assert_no_step_is_taken_again(counted):
    """Steps of order 8 take 11 accelerations, and one at their end; the start takes some."""
    assert counted["accelerations"] < 12 * (counted["steps"] + counted["rejected"]) + 20


def test_functions_far_from_their_edges_are_looked_at_once_a_step():
    """At the end of each step; near an edge also for rates there, and within the step."""
    for half_width, at_least, at_most in ((100, 1.0, 1.1), (1.0001, 1.5, 3.1)):
        line = f"{{table: [[-{half_width}, -{half_width}], [{half_width}, {half_width}]], lines: true}}"
        job = prepare(pushed(line, "-p(b.x)"), duration=30.0, points=2, solver="bdf")
        before = job.dynamics.state.evaluations
        counted = job.integrate().statistics
        looks = job.dynamics.state.evaluations - before - counted["residuals"] - counted["jacobians"]
        assert at_least * counted["steps"] <= looks < at_most * counted["steps"] + 20


def test_a_periodic_table_repeats_its_zones():
    found, period = breakpoints("{table: [[0, 0], [0.9, 0], [0.95, 1], [1, 0]], lines: true, ends: periodic}")
    assert period == 1 and found.tolist() == [0, 0.9, 0.95]


def test_every_period_of_a_narrow_tooth_is_felt():
    """Teeth of 0.05 N m, one a metre, from 1 m/s on: each adds its work."""
    scene = pushed("{table: [[0, 0], [0.9, 0], [0.95, 1], [1, 0]], lines: true, ends: periodic}")
    for how in ({"solver": "bdf"}, {"solver": "projected", "scheme": "dop853"}):
        solution = stiffmbs.run(scene, duration=3.0, points=2, rtol=1e-7, **how)
        teeth = np.floor(solution["b.x"][-1])
        assert solution["b.vx"][-1] ** 2 == pytest.approx(1 + 2 * 0.05 * teeth, rel=1e-3)
    assert solution.solver["events"] == 0, "explicit steps go on where no law changes"


def test_a_law_that_steps_resolve_stops_no_integrator():
    """A body that swings slowly over a smooth table and tanh: no event, and no more steps than without a search."""
    x = np.linspace(-5, 5, 41)
    table = f"{{table: {np.column_stack([x, -x]).tolist()}}}"
    scene = pushed(table, "p(b.x) - 0.1*tanh(b.vx)")
    assert stiffmbs.run(scene, duration=20.0, points=2, solver="bdf").solver["events"] == 0
    assert_no_step_is_taken_again(stiffmbs.run(scene, duration=20.0, points=2, solver="projected").solver)


def test_the_first_of_several_events_in_a_step_comes_first():
    """A ball between two posts that it meets one after the other, each within the free flight of one step."""
    scene = stiffmbs.read_scene("""
gravity: [0, 0]
bodies: {b: {mass: 1, inertia: 1, velocity: [10, 0]}}
forces:
  far: {type: contact, i: b, j: {body: ground, point: [6, 0]}, surface: circle, surface_radius: 0.5, stiffness: 1e8}
  near: {type: contact, i: b, j: {body: ground, point: [3, 0]}, surface: circle, surface_radius: 0.5, stiffness: 1e8}
""")
    for how in (
        {"solver": "bdf"},
        {"solver": "projected", "scheme": "dop853"},
        {"solver": "projected", "scheme": "dopri5"},
    ):
        solution = stiffmbs.run(scene, duration=1.0, points=2, **how)
        assert solution["b.vx"][-1] == pytest.approx(-10, rel=1e-3)
        assert solution["b.x"][-1] == pytest.approx(2.5 - 7.5, abs=0.05)


@pytest.mark.long
@pytest.mark.parametrize("velocity, start", [(-1.0, 0.3847), (-1.0, 0.4017), (-0.5, 0.3424), (-0.5, 0.3593)])
def test_the_first_touch_comes_first_where_the_step_ends_in_a_later_one(velocity, start):
    """A pin on a spinning disc that drifts to a wall touches it, leaves it, and touches it again a turn later.

    The step's end lies where the pin withdraws faster than its dissipation lets the contact push: no error test sees it.
    """
    scene = stiffmbs.read_scene(f"""
gravity: [0, 0]
bodies: {{b: {{mass: 1, inertia: 0.01, position: [{start}, 0], velocity: [{velocity}, 0], omega: 100}}}}
forces:
  wall:
    type: contact
    i: {{body: b, point: [0.1, 0]}}
    j: {{body: ground, angle: {-np.pi / 2}}}
    stiffness: 1e6
    dissipation: 0.3
""")
    explicit = {"solver": "projected", "scheme": "dop853"}
    true = stiffmbs.run(scene, duration=1.0, points=2, rtol=1e-9, max_step=2e-4, **explicit)["b.x"][-1]
    for how in ({"solver": "bdf"}, explicit, {"solver": "projected", "scheme": "dopri5"}):
        solution = stiffmbs.run(scene, duration=1.0, points=2, rtol=1e-7, **how)
        assert solution["b.x"][-1] == pytest.approx(true, rel=1e-3)


def test_the_end_of_a_push_within_the_overlap_is_an_event():
    """A body pulled out of a wall faster than 1/dissipation is released before it has left the wall."""
    scene = stiffmbs.read_scene(f"""
gravity: [0, 0]
bodies: {{b: {{mass: 1, inertia: 1, position: [-0.5, 0], velocity: [4.5, 0]}}}}
forces:
  pull: {{type: force, i: b, force: [10, 0]}}
  wall:
    type: contact
    i: b
    j: {{body: ground, angle: {-np.pi / 2}}}
    stiffness: 100
    exponent: 1
    dissipation: 0.2
""")
    for how in ({"solver": "bdf"}, {"solver": "projected", "scheme": "dop853"}):
        solution = stiffmbs.run(scene, duration=0.06, points=2, rtol=1e-9, **how)
        assert solution["b.x"][-1] < 0 and solution["b.vx"][-1] > 5
        assert solution.solver["events"] == 1


@pytest.mark.long
def test_an_argument_that_rests_on_a_point_of_its_table_is_no_event():
    """Interpolants differ from a coordinate that rests by roundings, which lie on both sides of the point."""
    scene = stiffmbs.read_scene("""
        gravity: [0, -9.81]
        bodies:
          sled: {mass: 1, inertia: 1, position: [0.8117493111092512, 0.3]}
          ball: {mass: 1, inertia: 1, position: [0, 2], velocity: [1, 0]}
        joints:
          held: {type: equation, zero: sled.x - 0.8117493111092512}
          rest: {type: equation, zero: "sled.y - 0.3 + p(sled.x) - p(0.8117493111092512)"}
        forces:
          spring: {type: spring_damper, i: sled, j: ball, stiffness: 40, free_length: 1}
        tables:
          p: {table: [[-1.688250688890749, 0], [-0.4382506888907488, 1], [0.8117493111092512, 0.2], [1.311749311109251, 0.9], [3.311749311109251, 0]]}
    """)
    solution = stiffmbs.run(scene, duration=1.0, points=11, rtol=1e-7, presolve=False)
    assert solution.success and solution.solver["events"] < 20


@pytest.mark.parametrize("rtol", [1e-2, 1e-3])
def test_a_peak_is_seen_that_lies_before_another_place_of_its_zones(rtol):
    """The argument 1 + z^2 falls to the peak at z = 0 and rises into another zone within one step."""
    first, width, size = 0.04251988070687207, 5.908546782551748e-05, 1629.9929796030797
    scene = pushed("{table: [[0, 0], [1, 1]]}", f"{size}*(1/(1 + 16*(((b.x - {first})/{width}) - 0.5)^2))")
    found = stiffmbs.run(scene, duration=0.292, points=2, solver="projected", scheme="dopri5", rtol=rtol)["b.vx"][-1]
    assert found == pytest.approx(np.sqrt(1 + 2 * size * width * np.pi / 4), abs=0.01)


@pytest.mark.parametrize(("intervals", "turns"), [(8, True), (9, False)])
def test_a_periodic_table_of_few_zones_turns(intervals, turns):
    """Its features are long beside the period, as those of a sine are; features of a table of more zones bound steps by themselves."""
    heights = [(-1) ** k * k for k in range(intervals)]
    table = {"lines": True, "ends": "periodic", "table": [[k, float(y)] for k, y in enumerate([*heights, heights[0]])]}
    found = intervals_of(compile_model(pushed(table, velocity=1.0)))
    assert len(found.breakpoints) == intervals
    assert found.turns.tolist() == [0] * turns
    assert found.radians.tolist() == pytest.approx([2 * np.pi / intervals] * turns)


TEETH = "{lines: true, ends: periodic, table: [[0, 0], [0.7, 0], [0.85, 1], [1, 0]]}"


@pytest.mark.long
@pytest.mark.sampled(9)
@pytest.mark.parametrize(
    ("how", "rtol", "allowed"),
    [({"solver": "projected", "scheme": scheme}, rtol, 0.1 * rtol) for scheme in ("dop853", "dopri5") for rtol in (1e-3, 1e-4, 1e-6)] + [({"solver": "bdf"}, 1e-4, 1e-2)],
)  # fmt: skip
@pytest.mark.parametrize("points", [2, 401])
def test_a_thousand_teeth_of_a_table_do_the_work_under_them(how, rtol, allowed, points):
    """The body passes 1000 periods of 1 mm; errors in equal teeth add up."""
    solution = stiffmbs.run(pushed(TEETH, "2*p(1000*b.x)"), duration=0.9, points=points, rtol=rtol, **how)
    x, v = solution["b.x"][-1], solution["b.vx"][-1]
    whole, part = divmod(1000 * x, 1)
    area = np.trapezoid(np.interp(z := np.linspace(0, part, 10_001), [0, 0.7, 0.85, 1], [0, 0, 1, 0]), z)
    assert (v**2 - 1) / 2 == pytest.approx(2 * (0.15 * whole + area) / 1000, rel=allowed)


@pytest.mark.parametrize("rtol", [1e-7, 1e-9, 1e-11])
def test_an_event_nearer_than_rounding_of_a_state_is_passed(rtol):
    """The motion moves by less than the last digit of `phase` in the shortest steps; errors of 240 equal windows add up."""
    rate, phase, level, speed = 1689.0429187215786, 2.061649960857018, 0.9997630796299394, 0.7361015900954847
    scene = stiffmbs.read_scene(f"""
        dimensions: 2
        gravity: [0, 0]
        bodies:
          b: {{mass: 1, inertia: 1}}
        forces:
          f: {{type: force, i: b, force: ["branch(sin({rate}*p + {phase}) - {level}, 0, 0, 167)", 0]}}
        states:
          p: {{rate: {speed}, start: -0.7657753969548087}}
    """)
    solution = stiffmbs.run(scene, duration=0.8, points=2, rtol=rtol, solver="projected", scheme="dop853")
    p = solution["p"]
    angles = rate * np.linspace(p[0], p[0] + 0.8 * speed, 2) + phase
    half = np.arccos(level)
    centres = np.arange(
        np.ceil((angles[0] - np.pi / 2) / (2 * np.pi)), np.floor((angles[1] - np.pi / 2) / (2 * np.pi)) + 1
    )
    assert solution.success
    assert solution["b.vx"][-1] == pytest.approx(167 * len(centres) * 2 * half / (rate * speed), rel=1e-7)
