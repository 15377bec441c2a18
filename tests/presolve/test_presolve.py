"""The presolve: the same numbers with fewer unknowns, and every line of its report."""

from __future__ import annotations

import itertools
import json

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs import Body, Marker, Model
from stiffmbs.analyses.job import prepare
from stiffmbs.commands.main import main
from stiffmbs.compile.coordinates import all_independent
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.trajectory import Outcome
from tests.stress.random_tree import random_tree

EXAMPLES = [
    "andrews", "bar_pendulum", "bouncing_ball", "cart_pendulum", "chain", "dead_centres", "four_bars", "half_car", "stick_slip",
]  # fmt: skip
WELDED = """
gravity: [0, -9.81]
bodies:
  cart: {mass: 10, inertia: 1, velocity: [0.3, 0]}
  box: {mass: 2, inertia: 0.1, position: [0.2, 0.3], angle: 20 deg}
  bar: {mass: 1, inertia: 0.03, position: [0.3, 0], markers: {left: {point: [-0.3, 0]}}}
  tip: {mass: 0.5, inertia: 0.01, position: [0.6, 0.1], angle: 0.3}
  top: {mass: 0.2, inertia: 0.02, position: [0.6, 0.3], angle: -1}
  lonely: {mass: 1, inertia: 1, position: [0, 3], omega: 1}
joints:
  rail: {type: prismatic, i: {body: cart, point: [0.1, 0.2], angle: -0.4}, j: {body: ground, point: [0.1, 0.2], angle: -0.4}}
  lid: {type: fixed, i: box, j: {body: cart, point: [0.2, 0.3], angle: 20 deg}}
  hinge: {type: revolute, i: bar.left, j: cart}
  weld: {type: fixed, i: tip, j: {body: bar, point: [0.3, 0.1], angle: 0.3}}
  cap: {type: fixed, i: {body: tip, point: [0, 0.2], angle: -1.3}, j: top}
forces:
  spring: {type: spring_damper, i: top, j: ground, stiffness: 50 N/m, damping: 1, free_length: 0.5}
  pull: {type: force, i: {body: box, point: [0.1, 0]}, force: [3*sin(5*t), "-2*vy(top, box)"]}
  other: {type: spring_damper, i: lonely, j: ground, stiffness: 50 N/m, free_length: 0.5}
requests:
  gap: dm(top, lonely)
run: {duration: 2, points: 101}
"""


def both(model, **changes):
    return (stiffmbs.run(model, presolve=presolve, **changes) for presolve in (True, False))


def test_what_a_run_has_set_up_is_made_anew_for_other_coordinates(examples):
    job = prepare(stiffmbs.load_scene(examples / "cart_pendulum.yaml"), duration=1.0)
    with_fewer = job.integrate()
    job.dynamics.coordinates = all_independent(job.dynamics.system)
    with_all = job.integrate()
    assert with_all.statistics["linear_solver"] != with_fewer.statistics["linear_solver"]
    np.testing.assert_allclose(with_all.q, with_fewer.q, atol=1e-4)


@pytest.mark.long
@pytest.mark.parametrize("interruptions", [range(3, 4), range(3, 10**9)])
def test_what_was_solved_before_an_interruption_is_kept_of_all_mechanisms(interruptions):
    calls = itertools.count(1)

    def watch(t):
        if next(calls) in interruptions:
            raise KeyboardInterrupt

    scene = read_scene(WELDED, [("run.duration", "200"), ("run.points", "100001")])
    whole = stiffmbs.run(scene, duration=10.0, points=5001)
    solution = stiffmbs.run(scene, watch=watch)
    assert solution.outcome is Outcome.INTERRUPTED
    assert len(solution.time) > 100
    count = min(len(solution.time), len(whole.time))
    for name in ("bar.angle", "lonely.y", "spring.fx"):
        np.testing.assert_allclose(solution[name][:count], whole[name][:count], rtol=1e-3, atol=1e-3)


def test_check_reports_what_a_run_with_its_settings_leaves_out(examples):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    assert stiffmbs.check(scene).unknowns == (20, 12)
    for changes in ({"presolve": False}, {"solver": "kinematic"}):
        report = stiffmbs.check(scene, **changes)
        assert report.unknowns == (20, 20)
        assert report.presolve == ()


def assert_same(with_it, without, tolerance):
    """Every channel, relative to the largest of its family (forces, torques, coordinates, ...)."""
    assert list(with_it) == list(without)
    np.testing.assert_array_equal(with_it.time, without.time)
    for name in without:
        family = name.rpartition(".")[2]
        size = max(np.max(np.abs(without[other])) for other in without if other.rpartition(".")[2] == family)
        assert np.max(np.abs(with_it[name] - without[name])) <= tolerance * max(size, 1e-3), name


def solved_unknowns(job):
    from stiffmbs.redundancy.messages.presolve_report import unknowns

    return unknowns(job.dynamics.system, job.subsystems, job.dynamics)


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_have_the_same_numbers_without_it(examples, name):
    scene = stiffmbs.load_scene(examples / f"{name}.yaml")
    assert_same(*both(scene, solver="bdf", rtol=1e-9, duration=min(scene.run.duration, 1.0)), 5e-5)


@pytest.mark.parametrize(("solver", "scheme"), [("bdf", "dop853"), ("projected", "dop853")])
def test_welded_bodies_and_independent_mechanisms(solver, scheme):
    with_it, without = both(read_scene(WELDED), solver=solver, scheme=scheme, rtol=1e-10)
    assert_same(with_it, without, 2e-7)
    assert with_it.presolve[-1] == f"62 unknowns reduced to {18 if solver == 'bdf' else 26}"


def test_differences_shrink_with_the_tolerance():
    """As errors of order 5 do, by rtol^(5/6): 2000 times over four powers of ten.

    `lonely` stands to one side of its spring's anchor.  Above it, it falls through: a spring of no length has a force that
    jumps from one direction to the other, and how well steps meet the jump is luck (3 to 30 times a power of ten).
    """
    scene = read_scene(WELDED, [("bodies.lonely.position", "[1, 3]")])
    gaps = []
    for rtol in (1e-5, 1e-7, 1e-9):
        with_it, without = both(scene, solver="bdf", rtol=rtol)
        gaps.append([np.max(np.abs(with_it[name] - without[name])) for name in ("bar.angle", "lonely.y", "cart.x")])
    assert max(gaps[0]) < 1e-3
    for looser, tighter in itertools.pairwise(np.array(gaps)):
        assert np.all(tighter < looser / 10)
    assert np.all(np.array(gaps[2]) < np.array(gaps[0]) / 500)


def test_the_report_line_by_line():
    report = stiffmbs.check(read_scene(WELDED))
    assert report.presolve == (
        "bodies merged by fixed joints: cart and box",
        "bodies merged by fixed joints: bar, tip and top",
        "coordinates fixed by constant equations: box.angle",
        "coordinates in a constant ratio: box.y (-0.422793 of box.x)",
        "multipliers recovered afterwards: rail.normal and rail.angle",
        "2 independent mechanisms solved separately: cart, box, bar, tip and top; lonely",
        "62 unknowns reduced to 18",
    )
    assert report.unknowns == (62, 18)


def test_the_report_reaches_the_user(tmp_path):
    scene = tmp_path / "welded.yaml"
    scene.write_text(WELDED)
    shown = CliRunner().invoke(main, ["run", str(scene), "-o", str(tmp_path / "out.csv")])
    assert "presolve     bodies merged by fixed joints: cart and box" in shown.output
    found = json.loads(CliRunner().invoke(main, ["run", str(scene), "--json"]).output)
    assert "62 unknowns reduced to 18" in found["presolve"]
    checked = CliRunner().invoke(main, ["check", str(scene), "--json"])
    assert json.loads(checked.output)["unknowns"] == {"before": 62, "after": 18}
    off = json.loads(CliRunner().invoke(main, ["run", str(scene), "--json", "--set", "run.presolve=false"]).output)
    assert off["presolve"] == []


def wheels():
    """Two wheels pinned at their centres of mass, geared, and a slider whose guide stands at 30 deg on a turning arm."""
    model = Model(gravity=(0, -9.81))
    model.add("one", Body(mass=2, inertia=0.4, omega=3))
    model.add("two", Body(mass=1, inertia=0.1, position=(0.5, 0)))
    model.add("pin1", JOINTS["revolute"](i="one", j="ground"))
    model.add("pin2", JOINTS["revolute"](i="two", j=Marker(body="ground", point=(0.5, 0))))
    model.add("mesh", JOINTS["gear"](joint_1="pin1", joint_2="pin2", ratio=0.5))
    model.add("coil", FORCES["torsion_spring"](i="one", j="ground", stiffness=20))
    model.add("slider", Body(mass=0.7, inertia=0.02, position=(0.3, 0)))
    model.add("slot", JOINTS["prismatic"](i="slider", j="one"))
    model.add("spring", FORCES["spring_damper"](i="slider", j="one", stiffness=300, free_length=0.3))
    return model


def test_gears_and_sliders_are_tied():
    with_it, without = both(wheels(), duration=1.0, points=51, rtol=1e-10)
    assert_same(with_it, without, 1e-6)
    assert with_it.presolve[0] == "coordinates fixed by constant equations: one.x, one.y, two.x and two.y"
    assert (
        "one.angle (-0.5 of two.angle)" in with_it.presolve[1] or "two.angle (-2 of one.angle)" in with_it.presolve[1]
    )
    np.testing.assert_allclose(with_it["mesh.torque"], without["mesh.torque"], atol=1e-6)


def test_multipliers_that_friction_hangs_on_stay(examples):
    job = prepare(stiffmbs.load_scene(examples / "stick_slip.yaml"))
    kept = {
        name
        for name, gone in zip(job.dynamics.system.equations, job.dynamics.coordinates.satisfied, strict=True)
        if not gone
    }
    assert ("slide", "normal") in kept


def test_equations_of_time_or_with_corners_stay():
    model = Model()
    model.add("a", Body(mass=1, inertia=1))
    model.add("b", Body(mass=1, inertia=1))
    model.add("driven", JOINTS["equation"](zero="a.x - sin(t)"))
    model.add("cornered", JOINTS["equation"](zero="a.y + max(b.y, -100)"))
    model.add("straight", JOINTS["equation"](zero="a.angle - 2*b.angle"))
    coordinates = (
        prepare(model, duration=0.1).subsystems[0].dynamics.coordinates
        if prepare(model).subsystems
        else prepare(model).dynamics.coordinates
    )
    assert coordinates.satisfied.tolist() == [False, False, True]


def test_drifts_and_fixed_steps_are_shown_as_they_are():
    scene = read_scene(WELDED)
    for changes in (
        {"solver": "projected", "scheme": "euler_cromer"}, {"solver": "projected", "scheme": "rk4"}, {"solver": "projected", "scheme": "dop853", "projection": False},
    ):  # fmt: skip
        assert not prepare(scene, **changes).subsystems


def test_a_redundant_weld_is_not_made_stronger():
    """Two blocks on parallel rails, welded: two equations too many; whatever is left out, the results are the same."""
    model = Model(gravity=(1.0, -9.81))
    for k, name in enumerate(("one", "two")):
        model.add(name, Body(mass=1 + k, inertia=0.1, position=(0.5 * k, 0)))
        model.add(f"rail{k}", JOINTS["prismatic"](i=name, j=Marker(body="ground", point=(0.5 * k, 0))))
    model.add("weld", JOINTS["fixed"](i=Marker(body="two", point=(-0.5, 0)), j="one"))
    for drop_first in ((), ("weld",), ("rail0",)):
        with_it, without = both(model, duration=1.0, points=11, rtol=1e-9, drop_first=drop_first)
        np.testing.assert_allclose(with_it["one.x"], 0.5 * with_it.time**2, atol=1e-8)
        np.testing.assert_allclose(with_it["one.x"], without["one.x"], atol=1e-8)
        np.testing.assert_allclose(with_it["weld.fy"], without["weld.fy"], atol=1e-8)


def test_a_body_that_nothing_lets_move():
    model = Model(gravity=(0, -9.81))
    model.add("stone", Body(mass=2, inertia=1))
    model.add("floor", JOINTS["fixed"](i="stone", j="ground"))
    solution = stiffmbs.run(model, duration=1.0, points=5)
    np.testing.assert_allclose(solution["floor.fy"], 2 * 9.81, rtol=1e-12)


@pytest.mark.long
@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 10**6), count=st.integers(2, 6), welds=st.integers(1, 3))
def test_random_trees_with_welds(seed, count, welds):
    rng = np.random.default_rng(seed)
    model = random_tree(rng, count, gravity=True, grounded=True, springs=2)
    for k in range(welds):
        parent = f"{list(model.bodies)[int(rng.integers(count))]}"
        place, angle = tuple(rng.uniform(-0.5, 0.5, 2)), rng.uniform(-3, 3)
        body = model.bodies[parent]
        c, s = np.cos(body.angle), np.sin(body.angle)
        at = (body.position[0] + c * place[0] - s * place[1], body.position[1] + s * place[0] + c * place[1])
        name = f"welded{k}"
        model.add(
            name, Body(mass=rng.uniform(0.1, 2), inertia=rng.uniform(0.01, 0.1), position=at, angle=body.angle + angle)
        )
        model.add(f"weld{k}", JOINTS["fixed"](i=name, j=Marker(body=parent, point=place, angle=angle)))
    with_it, without = both(model, duration=0.3, points=11, rtol=1e-10)
    before, after = solved_unknowns(prepare(model))
    assert after <= before - 12 * welds
    assert_same(with_it, without, 1e-5)
