"""Radau methods: their orders, motion against closed forms and other integrators, and work that stiffness does not change."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Drive, Model, Prismatic, Revolute, SpringDamper, spatial
from tests.bench.solvers.stiff_and_light import CAR_AXIS
from tests.stress.families.stiffness.stiffness import bar_on_bushing
from tests.stress.families.structure.headline import loop, swing_of
from tests.stress.mechanisms.pendulum import bar_rate, swing

STAGES = pytest.mark.parametrize("stages", [3, 5, 7])


def oscillator(frequency=2 * np.pi, **fields):
    model = Model()
    model.add("mass", Body(mass=1, inertia=1, position=(0.3, 0)))
    model.add("rail", Prismatic(i="mass", j="ground"))
    model.add(
        "spring",
        SpringDamper(
            i="mass", j=stiffmbs.Marker(body="ground", point=(-2, 0)), stiffness=frequency**2, free_length=2, **fields
        ),
    )
    return model  # fmt: skip


@pytest.mark.parametrize(("stages", "steps"), [(3, 40), (5, 10), (7, 6)])
def test_errors_fall_with_the_order_of_the_method(stages, steps):
    """Steps of a given length over four periods; order 2 s - 1 at their ends."""
    errors = []
    for count in (steps, 2 * steps):
        settings = {"max_step": 2.0 / count, "rtol": 0.1, "atol": 1e3, "points": 2}
        end = stiffmbs.run(oscillator(), duration=2.0, solver="radau", stages=stages, **settings)
        errors.append(np.hypot(end["mass.x"][-1] - 0.3, end["mass.vx"][-1] / (2 * np.pi)))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2 * stages - 1, abs=1.0)


@STAGES
@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10])
def test_errors_at_all_output_times_follow_the_tolerance(stages, rtol):
    found = stiffmbs.run(oscillator(), duration=3.0, points=200, solver="radau", stages=stages, rtol=rtol)
    np.testing.assert_allclose(found["mass.x"], 0.3 * np.cos(2 * np.pi * found.t), atol=3 * rtol)
    np.testing.assert_allclose(found["mass.vx"], -0.6 * np.pi * np.sin(2 * np.pi * found.t), atol=20 * rtol)


@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
@pytest.mark.parametrize("frequency", [20.0, 100.0])
def test_a_small_vibration_about_a_position_of_rest_is_not_damped(frequency, rtol):
    """Rates at the start are small, and the estimate of a step over many periods is small too: the method is L-stable."""
    speed = 1000 * rtol
    model = Model()
    model.add("mass", Body(mass=1, inertia=1, position=(1, 1), velocity=(speed, 0)))
    rest = stiffmbs.Marker(body="ground", point=(1, 1))
    model.add("held", stiffmbs.Bushing(i="mass", j=rest, stiffness=(frequency**2,) * 3))
    found = stiffmbs.run(model, duration=4.0, points=401, solver="radau", rtol=rtol)
    np.testing.assert_allclose(found["mass.vx"], speed * np.cos(frequency * found.t), atol=0.1 * speed)


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
def test_a_body_is_free_after_a_steep_force_has_ended(rtol):
    """Corrections by the matrix of the steep force are small: they do not show that the iteration has converged."""
    roof = {"table": [[-1e6, 0], [0, 0], [0.25, 1], [1, 0], [1e6, 0]], "lines": True}
    scene = {
        "gravity": [0, 0], "bodies": {"b": {"mass": 1, "inertia": 1, "velocity": [1, 0]}}, "tables": {"roof": roof},
        "forces": {"f": {"type": "force", "i": "b", "force": ["2800*roof(b.x/0.00025)", 0]}},
    }  # fmt: skip
    scene, speed = stiffmbs.read_scene(json.dumps(scene)), np.sqrt(1 + 2800 * 0.00025)
    for duration in np.linspace(0.3, 1.2, 100):  # it determines the steps
        end = stiffmbs.run(scene, duration=duration, points=2, solver="radau", rtol=rtol)
        assert end["b.vx"][-1] == pytest.approx(speed, abs=5e-4 * speed if rtol < 1e-5 else 5e-3 * speed)


@pytest.mark.parametrize("stiffness", [1e6, 1e9, 1e12])
def test_steps_and_forces_do_not_depend_on_the_stiffness(stiffness):
    """A bar that swings on a bushing, against a hinge, once the ringing of the start is over."""
    found = stiffmbs.run(bar_on_bushing(stiffness), duration=2.0, points=201, rtol=1e-6, solver="radau")
    phi = swing(found.t, np.pi / 2, bar_rate(1.0))
    force = 9.81 * (2.5 * np.cos(phi) ** 2 + 0.25 * np.sin(phi) ** 2)
    late = slice(len(phi) // 4, None)
    softness = 1e6 / stiffness
    np.testing.assert_allclose(found["bearing.fy"][late], force[late], atol=9.81 * (1e-3 + 0.1 * softness))
    assert found.solver["steps"] < 300


@pytest.mark.parametrize("k_b", ["1e7 N/m", "1e11 N/m"])
def test_a_stiff_car_over_a_bump(examples, k_b):
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", k_b)])
    exact = stiffmbs.run(scene, rtol=1e-10, solver="bdf")
    found = stiffmbs.run(scene, rtol=1e-6, solver="radau")
    np.testing.assert_allclose(found["chassis.y"], exact["chassis.y"], atol=1e-6)
    largest = np.abs(exact["front_bushing.fy"]).max()
    np.testing.assert_allclose(found["front_bushing.fy"], exact["front_bushing.fy"], atol=2e-3 * largest)
    assert found.solver["steps"] < 200


@pytest.mark.parametrize("k_b", ["1e8 N/m", "1e10 N/m"])
def test_forces_are_as_accurate_at_many_outputs_as_at_few(examples, k_b):
    """Many outputs within a step share interpolated corrections; a few are corrected one by one."""
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", k_b), ("zeta", "0.05")])
    many, few = (stiffmbs.run(scene, rtol=1e-6, solver="radau", points=points) for points in (4001, 81))
    largest = np.abs(few["front_bushing.fy"]).max()
    np.testing.assert_allclose(many["front_bushing.fy"][::50], few["front_bushing.fy"], atol=5e-5 * largest)


@pytest.mark.parametrize("stages", [5, 7])
@pytest.mark.parametrize("rtol", [1e-10, 1e-12])
def test_forces_within_a_step_are_accurate_at_small_tolerances(stages, rtol):
    """The polynomial of a step has the order of the estimate, whose tolerance is up to 3000 times the requested one."""
    model = bar_on_bushing(1e8)
    exact = stiffmbs.run(model, duration=0.25, points=76, rtol=1e-13, solver="projected")
    found = stiffmbs.run(model, duration=0.25, points=76, rtol=rtol, solver="radau", stages=stages)
    largest = np.abs(exact["bearing.fy"]).max()
    np.testing.assert_allclose(found["bearing.fy"], exact["bearing.fy"], atol=1e-6 * largest)
    assert not [note for note in found.notes if "interpolated" in note]


def hinged_on_bushing(stiffness):
    """Return a model with a bar on a bushing, and a second bar on its end."""
    model = bar_on_bushing(stiffness)
    second = model.add("second", Body(mass=0.5, inertia=0.05, position=(1.4, 0)))
    model.add("hinge", Revolute(i=second.at(-0.4, 0), j=stiffmbs.Marker(body="bar", point=(0.5, 0))))
    return model


@pytest.mark.parametrize("stages", [3, 5, 7])
def test_constraints_of_accelerations_suit_stiff_forces(stages):
    """They do not close joints at the ends of steps; with such corrections, 4000 steps drifted by 5e-4 m."""
    settings = {"duration": 1.0, "points": 101, "solver": "radau"}
    exact = stiffmbs.run(hinged_on_bushing(1e7), rtol=1e-10, **settings)
    found = stiffmbs.run(hinged_on_bushing(1e7), rtol=1e-6, formulation="index1", stages=stages, **settings)
    np.testing.assert_allclose(found["second.angle"], exact["second.angle"], atol=2e-5)
    for force in ("bearing.fy", "hinge.fy"):
        np.testing.assert_allclose(found[force], exact[force], atol=1e-3 * np.abs(exact[force]).max())
    assert found.solver["steps"] < 200
    assert found.solver["drift"] < 1e-5


@pytest.mark.parametrize("formulation", ["SI2", "SI1"])
def test_outputs_within_a_step_share_corrections_in_mechanisms_with_joints(formulation):
    model = hinged_on_bushing(1e7)
    settings = {"duration": 1.0, "rtol": 1e-6, "solver": "radau", "formulation": formulation}
    many, few = (stiffmbs.run(model, points=points, **settings) for points in (8001, 41))
    late = slice(10, None)  # once the ringing of the start is over
    for force in ("bearing.fy", "hinge.fx", "hinge.fy"):
        largest = np.abs(few[force][late]).max()
        np.testing.assert_allclose(many[force][::200][late], few[force][late], atol=1e-5 * largest)
    assert many.solver["residuals"] < few.solver["residuals"] + 4000


@pytest.mark.parametrize("formulation", ["SI2", "SI2_exact", "SI1", "I3", "index1"])
def test_formulations_give_one_motion(examples, formulation):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    exact = stiffmbs.run(scene, rtol=1e-11, duration=2.0, solver="projected")
    found = stiffmbs.run(scene, rtol=1e-7, duration=2.0, solver="radau", formulation=formulation)
    np.testing.assert_allclose(found["bar.angle"], exact["bar.angle"], atol=1e-5)


def test_index_3_tests_velocities_times_the_step(examples):
    """Without the test, the stiff bearing has velocity errors of 330 tolerances, in 494 steps, which is 30 times as many."""
    scene = stiffmbs.load_scene(examples / "elastic_bearing.yaml")
    exact = stiffmbs.run(scene, solver="radau", rtol=1e-10)
    found = stiffmbs.run(scene, solver="radau", formulation="I3", rtol=1e-6)
    assert found.solver["steps"] < 50
    velocities = [name for name in exact if name.endswith((".vx", ".vy", ".omega"))]
    largest = max(np.abs(exact[name]).max() for name in velocities)
    for name in velocities:
        np.testing.assert_allclose(found[name], exact[name], atol=100 * 1e-6 * largest)


def test_index_3_passes_a_late_start_at_a_tight_tolerance(examples):
    """Rounding of a time of 1e3 s is a part of the tolerance: iterations that ignore velocities do not converge."""
    scene = stiffmbs.load_scene(examples / "elastic_bearing.yaml")
    found = stiffmbs.run(scene, solver="radau", formulation="I3", rtol=1e-9, start=1e3)
    assert found.message == "completed"


def test_index_3_names_rounding_where_it_exceeds_the_tolerance(examples):
    """Rounding of a time of 1e5 s moves the driven crank by several tolerances: half of such runs stop."""
    scene = stiffmbs.load_scene(examples / "elastic_bearing.yaml")
    for start in (1e5, 1.06e5, 1.27e5, 1.33e5):
        found = stiffmbs.run(scene, solver="radau", formulation="I3", rtol=1e-9, start=start)
        assert (
            found.message == "completed" or "below rounding" in found.message or "below the rounding" in found.message
        )


def test_a_spinning_top_in_space():
    model = spatial.Model("top", gravity=(0, 0, -9.81))
    tilted = {"euler": "zxz", "angles": [0, 0.6, 0]}
    body = {"mass": 1, "inertia": (0.06, 0.06, 0.04), "center_of_mass": (0, 0, 0.2), "orientation": tilted}
    model.add("top", spatial.Body(**body, omega=(0, 0, 20)))
    model.add("tip", spatial.Spherical(i="top", j="ground"))
    exact = stiffmbs.run(model, duration=2.0, points=101, solver="projected", rtol=1e-12)
    found = stiffmbs.run(model, duration=2.0, points=101, solver="radau", rtol=1e-8)
    for axis in "xyz":
        np.testing.assert_allclose(found[f"top.{axis}"], exact[f"top.{axis}"], atol=1e-7)


@STAGES
def test_events_are_located_at_the_requested_tolerance(stages):
    """x'' = -5 sign(x) from x = 0 at 1 m/s: parabolas of 0.4 s; a step over a jump may not count as smooth."""
    model = Model()
    model.add("block", Body(mass=1, inertia=1, velocity=(1, 0)))
    model.add("rail", Prismatic(i="block", j="ground"))
    model.add("push", stiffmbs.AppliedForce(i="block", force=("-5*sign(block.x)", 0)))
    found = stiffmbs.run(model, duration=2.0, rtol=1e-9, solver="radau", stages=stages)
    t = np.mod(found.t, 0.8)
    expected = np.where(t < 0.4, t - 2.5 * t**2, -(t - 0.4) + 2.5 * (t - 0.4) ** 2)
    np.testing.assert_allclose(found["block.x"], expected, atol=1e-7)
    assert found.solver["events"] in (4, 5)


def test_a_breakpoint_belongs_to_the_time_before_it():
    """The velocity of |t - 0.5| jumps at a stop; the step before it must not take the law after it."""
    model = Model()
    model.add("sled", Body(mass=1, inertia=1, position=(0.5, 0)))
    model.add("rail", Prismatic(i="sled", j="ground"))
    model.add("motor", Drive(joint="rail", position="abs(t - 0.5)"))
    found = stiffmbs.run(model, duration=1.0, points=11, solver="radau")
    assert any("t = 0.5" in note and "sled.vx by 2" in note for note in found.notes)


def test_a_soft_spring_that_turns_fast_is_no_unknown():
    """A spring of no length through the origin: linear in coordinates, but not in its length."""
    model = spatial.Model()
    model.add("ball", spatial.Body(mass=2, inertia=(1, 1, 1), position=(0.3, 0, 0), velocity=(0.0, 0.02, 0.01)))
    model.add("spring", spatial.SpringDamper(i="ball", j="ground", stiffness=50))
    found = stiffmbs.run(model, duration=10.0, points=101, solver="radau", rtol=1e-8)
    np.testing.assert_allclose(found["ball.x"], 0.3 * np.cos(5 * found.t), atol=1e-7)
    assert found.solver["newton_failures"] < 0.1 * found.solver["steps"]


def test_a_pendulum_through_many_turns_keeps_its_energy():
    model = Model(gravity=(0, -9.81))
    model.add("bar", Body(mass=1, inertia=0.1, position=(0.5, 0)))
    model.add("pin", Revolute(i=stiffmbs.Marker(body="bar", point=(-0.5, 0)), j="ground"))
    found = stiffmbs.run(model, duration=20.0, solver="radau", rtol=1e-9)
    assert found.energy_drift() < 1e-6
    assert found.solver["steps"] < 1000


@pytest.mark.parametrize("rtol", [1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11])
def test_the_first_step_after_an_event_follows_the_new_law(rtol):
    """A vibration about 0 that a constant force moves to 0.125 m while x < 0.04 m; the law follows an algebraic state."""
    scene = stiffmbs.read_scene(
        """
bodies: {cart: {mass: 2, inertia: 1, position: [0.1, 0]}}
states: {p: {zero: p - 5*cart.x - 1, start: 1.5}}
forces: {push: {type: force, i: cart, force: ["-40*cart.x + branch(p - 1.2, 5, 0, 0)", 0]}}
run: {duration: 1 s, points: 11, solver: radau}
"""
    )
    found = stiffmbs.run(scene, rtol=rtol)
    w = np.sqrt(20.0)
    first, v = np.arccos(0.4) / w, -0.1 * w * np.sin(np.arccos(0.4))
    low = 2 * (np.arctan2(v / w, 0.04 - 0.125) % np.pi) / w
    after = found.t - first
    below = 0.125 + (0.04 - 0.125) * np.cos(w * after) + v / w * np.sin(w * after)
    again = 0.1 * np.cos(w * (found.t - 2 * first - low))
    expected = np.select([after < 0, after < low], [0.1 * np.cos(w * found.t), below], again)
    np.testing.assert_allclose(found["cart.x"], expected, atol=max(10 * rtol, 1e-9))


@pytest.mark.long
def test_a_drifting_run_ends_before_it_follows_another_mechanism():
    """Torques of 1e9 N m hold two cranks against each other: relaxed constraints give way, and exact ones do not."""
    found = stiffmbs.run(loop(2, 1e9, False, 3.2), duration=1.0, points=21, solver="radau")
    assert found.success
    assert any("SI2_exact" in note for note in found.notes)
    assert swing_of(2, 3.2, found) < 1e-4
    assert found.solver["steps"] < 1000


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-8])
def test_the_first_step_within_a_short_interval_of_a_law_is_in_that_interval(rtol):
    """A force of 1 N s over 1 ms, up and down in straight lines from an event on, within a run of 10 s."""
    scene = stiffmbs.read_scene(
        """
bodies:
  pushed: {mass: 1, inertia: 1}
  guide: {mass: 1, inertia: 1, velocity: [1, 0]}
tables: {roof: {table: [[-1, 0], [0, 0], [0.5, 1], [1, 0], [2, 0]], lines: true}}
forces: {push: {type: force, i: pushed, force: ["2000*roof((guide.x - 5)/0.001)", 0]}}
run: {duration: 10 s, points: 11, solver: radau}
"""
    )
    found = stiffmbs.run(scene, rtol=rtol)
    assert found["pushed.vx"][-1] == pytest.approx(1, abs=max(1e-4, 10 * rtol))


@pytest.mark.long
def test_the_car_axis_of_the_test_set():
    """Values at 3 s published by Mazzia and Magherini, Test Set for Initial Value Problem Solvers, release 2.4."""
    found = stiffmbs.run(stiffmbs.read_scene(CAR_AXIS), solver="radau", rtol=1e-8, points=2)
    ends = [found[name][-1] for name in ("left.x", "left.y", "right.x", "right.y")]
    np.testing.assert_allclose(
        ends, [0.0493455784275403, 0.496989460230171, 1.04174252488542, 0.373911027265361], atol=1e-7
    )


def test_reactions_do_not_depend_on_the_way_onto_the_constraints():
    """A stiff bushing joins two bars of a pendulum. Smallest moves of 1e-12 m onto its pin changed reactions by hundreds of N."""
    bars = """
gravity: [0, -9.81]
bodies:
  first: {mass: 1, inertia: 0.01, position: [0.1, 0], velocity: [0, 0.5], omega: 5}
  second: {mass: 1, inertia: 0.01, position: [0.3, 0], velocity: [0, 1.5], omega: 5}
joints: {pin: {type: revolute, i: {body: first, point: [-0.1, 0]}, j: ground}JOINT}
FORCE
run: {duration: 0.5 s, points: 501, solver: radau, rtol: 1e-5}
"""
    ends = "i: {body: first, point: [0.1, 0]}, j: {body: second, point: [-0.1, 0]}"
    bushing = f"forces: {{bushing: {{type: bushing, {ends}, stiffness: [1e14, 1e14, 1e10]}}}}"
    stiff, rigid = (
        stiffmbs.run(stiffmbs.read_scene(bars.replace("JOINT", joint).replace("FORCE", force)))
        for joint, force in (("", bushing), (f", weld: {{type: fixed, {ends}}}", ""))
    )
    for name in ("pin.fx", "pin.fy"):  # the bushing vibrates at the start
        np.testing.assert_allclose(stiff[name][25:], rigid[name][25:], atol=0.002 * np.abs(rigid[name]).max())
