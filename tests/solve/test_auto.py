"""The choice of solver while a scene is solved."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Bushing, Distance, Model, Prismatic
from stiffmbs.analyses.job import prepare
from stiffmbs.solve import auto
from stiffmbs.solve.auto import AUTO, Interval, cost_ahead, implicit_solver, steps_of_decay
from stiffmbs.solve.explicit.stable_step import rates_at
from tests.bench.drives import CARS
from tests.stress.mechanisms.parallelogram import parallelogram, swing_error


@pytest.mark.parametrize("name", ["cart_pendulum", "four_bars", "bouncing_ball", "crank_slider"])
def test_scenes_that_are_not_stiff_stay_with_the_explicit_integrator(examples, name):
    scene = stiffmbs.load_scene(examples / f"{name}.yaml")
    chosen, explicit = (
        stiffmbs.run(scene, duration=0.5, **how)
        for how in ({"solver": "auto"}, {"solver": "projected", "scheme": "dop853"})
    )
    assert chosen.solver["name"] == "projected"
    assert "auto chose projected dop853" in chosen.notes
    np.testing.assert_array_equal(chosen.step_times, explicit.step_times)
    for channel in chosen:
        np.testing.assert_array_equal(chosen[channel], explicit[channel])


def test_a_scene_that_is_stiff_from_the_first_is_left_to_radau(examples):
    """The rate is that of the half car's equations by hand at rest: the fastest vibration is an arm's on its bushing."""
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e9")])
    chosen, implicit = (stiffmbs.run(scene, solver=solver, rtol=1e-4) for solver in ("auto", "radau"))
    assert chosen.solver["name"] == "radau"
    (note,) = (note for note in chosen.notes if note.startswith("auto chose"))
    rate = float(note.removeprefix("auto chose radau (fastest rate ").removesuffix(" 1/s)"))
    arm = np.array([[1 / 40 + 0.04**2 / 1.5, -0.35 * 0.04 / 1.5], [-0.35 * 0.04 / 1.5, 1 / 40 + 0.35**2 / 1.5]])
    np.testing.assert_allclose(rate, np.sqrt(2e9 * np.linalg.eigvalsh(arm)[-1]), rtol=0.05)
    np.testing.assert_array_equal(chosen.step_times, implicit.step_times)


@pytest.mark.long
def test_radau_is_taken_for_a_vibration_that_it_resolves_at_less_cost():
    """At rtol 1e-8 radau takes a third of the time of explicit steps, also before a damper stops the vibration."""
    model = Model()
    model.add("a", Body(mass=1, inertia=1, position=(0.01, 0)))
    model.add("rail", Prismatic(i="a", j="ground"))
    model.add("spring", AppliedForce(i="a", force=("-1e6*a.x - 2000*step5(t, 12, 0, 13, 1)*a.vx + 1e4*sin(t)", 0)))
    chosen = stiffmbs.run(model, solver="auto", duration=30.0, points=301, rtol=1e-8)
    assert chosen.solver["name"] == "radau"
    exact = stiffmbs.run(model, solver="projected", scheme="dop853", duration=30.0, points=301, rtol=1e-12)
    np.testing.assert_array_equal(chosen.time, exact.time)
    np.testing.assert_allclose(chosen["a.x"], exact["a.x"], atol=1e-6)
    assert len(chosen.step_times) == chosen.solver["steps"]
    assert np.all(np.diff(chosen.step_times) > 0)


@pytest.mark.long
def test_a_repeated_run_makes_the_same_choices():
    job = prepare(ringing(), solver="auto", duration=20.0, rtol=1e-8)
    first, again = job.integrate(), job.integrate()
    assert first.solver == "projected, radau"
    assert again.note == first.note
    np.testing.assert_array_equal(again.q, first.q)


def test_vibrations_that_die_out_do_not_end_a_trial_of_radau(examples):
    """They hold its steps shorter than explicit ones for a while, which is little beside the whole way."""
    for stiffness in ("1e7", "1e8", "1e9"):
        scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", stiffness)])
        assert stiffmbs.run(scene, solver="auto", rtol=1e-6).solver["name"] == "radau"


def stiffening(at, stiffness=1e9):
    """A mass on a soft spring to which a stiff one, damped, is added in one second around a given time."""
    grown = f"step5(t, {at}, 0, {at + 1}, 1)"
    model = Model()
    model.add("a", Body(mass=1, inertia=1, position=(1, 0)))
    model.add("b", Body(mass=1, inertia=1, position=(2, 0)))
    for name in ("a", "b"):
        model.add(f"rail_{name}", Prismatic(i=name, j="ground"))
    model.add("soft", AppliedForce(i="a", force=("-10*a.x", 0)))
    force = f"-{grown}*({stiffness}*(b.x - a.x - 1) + {2 * np.sqrt(stiffness)}*(b.vx - a.vx)) - 5*(b.x - 2)"
    model.add("stiff_b", AppliedForce(i="b", force=(force, 0)))
    model.add("stiff_a", AppliedForce(i="a", force=(f"-({force}) - 5*(b.x - 2)", 0)))
    return model


def test_a_scene_that_turns_stiff_changes_hands_when_it_does():
    model = stiffening(2.0)
    chosen = stiffmbs.run(model, solver="auto", duration=4.0, points=401, rtol=1e-7)
    expected = stiffmbs.run(model, solver="bdf", duration=4.0, points=401, rtol=1e-10)
    assert chosen.solver["name"] == "projected, radau"
    (note,) = (note for note in chosen.notes if note.startswith("auto chose"))
    handed = float(note.split("radau from t = ")[1].split(" s")[0])
    assert 2.0 < handed < 2.5
    np.testing.assert_array_equal(chosen.time, expected.time)
    np.testing.assert_allclose(chosen["a.x"], expected["a.x"], atol=1e-5)


def test_own_steps_of_a_run_that_changes_hands_come_once():
    solution = stiffmbs.run(stiffening(0.5), solver="auto", duration=2.0, points="steps", rtol=1e-6)
    assert solution.solver["name"] == "projected, radau"
    assert np.all(np.diff(solution.time) > 0)
    assert solution.time[0] == 0.0 and solution.time[-1] == 2.0


def ringing():
    """A body in full swing on an undamped bushing."""
    model = Model(gravity=(0, -9.81))
    model.add("a", Body(mass=1, inertia=0.1, position=(0, 0.01)))
    model.add("bush", Bushing(i="a", j=stiffmbs.Marker(body="ground"), stiffness=(1e6, 1e6, 1e3)))
    return model


def test_an_implicit_solver_that_falls_behind_is_left_again():
    """A vibration in full swing makes implicit steps more expensive than explicit ones; the motion is exact."""
    model = ringing()
    solution = stiffmbs.run(model, solver="auto", duration=20.0, points=101, rtol=1e-6)
    (note,) = (note for note in solution.notes if note.startswith("auto chose"))
    assert "then projected again from t = " in note
    assert len(note) < 500
    explicit = stiffmbs.run(model, solver="projected", scheme="dop853", duration=20.0, points=101, rtol=1e-6)
    assert 0.7 * explicit.solver["steps"] <= solution.solver["steps"] < 1.3 * explicit.solver["steps"]
    exact = -9.81e-6 + (0.01 + 9.81e-6) * np.cos(1e3 * solution.time)
    assert np.abs(solution["a.y"] - exact).max() < 1.1 * np.abs(explicit["a.y"] - exact).max()


@pytest.mark.long
def test_where_explicit_steps_stop_the_run_is_bdfs_from_its_start():
    """Cranks through a flat pose: a start near it, in mid-run, would put them on a wrong way.

    At rtol 1e-11 most explicit runs do not come over it, as rounding decides about accelerations beside it.
    """
    solutions = [
        stiffmbs.run(parallelogram(omega=omega), solver="auto", duration=0.3, points=31, rtol=1e-11)
        for omega in (9.0, 11.0, 14.0, 20.0, 30.0)
    ]
    assert max(swing_error(solution) for solution in solutions) < 3e-7  # bdf beside the flat pose: up to 7.4e-8
    left = [solution for solution in solutions if solution.solver["name"] == "bdf"]
    assert left
    assert all("auto chose bdf, because explicit integration stopped at t = " in solution.notes[0] for solution in left)


def test_flat_poses_are_passed_by_explicit_steps_where_no_digits_are_lost(examples):
    scene = stiffmbs.load_scene(examples / "four_bars.yaml", [("N", "2")])
    solution = stiffmbs.run(scene, solver="auto", duration=20.0, points=201, rtol=1e-8)
    assert solution.solver["name"] == "projected"
    top = 2 * solution["v0.x"][-1], 2 * solution["v0.y"][-1]
    # 24 of 25 tolerances about this one come over all flat poses, with errors of 1e-8 to 1.4e-6; of those about 1e-9 only half do
    assert top == pytest.approx((0.839746574269, 0.542978536412), abs=3e-6)


def test_output_points_within_one_explicit_step_do_not_ask_for_a_change_of_hands():
    """A pendulum of 100 m whose steps are seconds long, seen each 0.1 ms."""
    model = Model(gravity=(0, -9.81))
    model.add("bob", Body(mass=100, inertia=1, position=(5, -100)))
    model.add("rope", Distance(i="bob", j="ground", length=np.sqrt(10025)))
    solution = stiffmbs.run(model, solver="auto", duration=10.0, output=1e-4)
    assert solution.solver["name"] == "projected"
    assert solution.solver["steps"] < 20
    assert len(solution.time) == 100_001
    w = np.sqrt(9.81 / np.sqrt(10025))
    np.testing.assert_allclose(solution["bob.x"], 5 * np.cos(w * solution.time), atol=0.01)


def test_the_rate_is_asked_for_once_where_explicit_steps_to_the_end_cost_less_than_trials(examples, monkeypatch):
    asked = []
    monkeypatch.setattr(auto, "rates_at", lambda *state: asked.append(state[1]) or rates_at(*state))
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e5")])
    solution = stiffmbs.run(scene, solver="auto", rtol=1e-4, errors=False)
    assert solution.solver["name"] == "projected"
    assert asked == pytest.approx([0.0], abs=1e-12)  # just after a breakpoint at the start


def let_fall(height, damping):
    """A body in a bushing with a natural frequency of 1000 1/s."""
    model = Model(gravity=(0, -9.81))
    model.add("a", Body(mass=1, inertia=0.1, position=(0, height)))
    force = {"stiffness": (1e6, 1e6, 1e3), "damping": (damping, damping, 0)}
    model.add("bush", Bushing(i="a", j=stiffmbs.Marker(body="ground"), **force))
    return model


@pytest.mark.parametrize(
    ("height", "damping", "name"),
    [(-9.81e-6, 0, "radau"), (1e-3, 0, "projected"), (1e-3, 50, "projected"), (1e-3, 200, "radau")],
)
def test_radau_is_tried_from_the_start_if_no_vibration_lasts_long(height, damping, name):
    """Nothing excites the stiff vibration of a body in its balance; let fall, it keeps the steps short until it has decayed."""
    assert stiffmbs.run(let_fall(height, damping), solver="auto", duration=2.0, rtol=1e-4).solver["name"] == name


@pytest.mark.parametrize(("duration", "name"), [(4.0, "projected"), (10.0, "projected, radau")])
def test_a_later_trial_must_save_more_than_its_start(duration, name):
    assert stiffmbs.run(let_fall(1e-3, 0), solver="auto", duration=duration, rtol=1e-4).solver["name"] == name


@pytest.mark.long
def test_a_trial_that_costs_more_than_explicit_steps_is_left_early():
    """The bushings do not carry the weight: all vibrate for longer than the one that is excited most.

    Radau would take twice the cost of explicit steps to the end.
    """
    car = CARS[0]
    solution = stiffmbs.run(
        car.model("sweep", **{car.stiffness: "1e8", "zeta": "0.01"}), solver="auto", duration=1.0, rtol=1e-5
    )
    (note,) = (note for note in solution.notes if note.startswith("auto chose"))
    assert "projected again" in note


@pytest.mark.long
def test_steps_that_were_costly_for_an_interval_are_resumed():
    """A jump of the steering makes the steps of radau short for 0.2 s; explicit steps to the end of the run are twenty times as many."""
    solution = stiffmbs.run(CARS[0].model("step"), solver="auto", rtol=1e-6)
    assert solution.solver["steps"] < 1500


def test_the_cost_ahead_follows_the_decay_of_a_vibration():
    """The rate halves each second; it is compared with a sum over short intervals. A rate that does not fall stays."""
    t = np.linspace(2.5, 5.5, 3001)
    exact = np.trapezoid(100.0 * 0.5 ** (t - 2.0), t)
    last = Interval(2.0, 100.0)
    assert cost_ahead(Interval(0.0, 400.0), last, 2.5, 5.5) == pytest.approx(exact, rel=1e-6)
    assert cost_ahead(last, last, 2.5, 5.5) == cost_ahead(Interval(0.0, 50.0), last, 2.5, 5.5) == 300.0


@pytest.mark.parametrize(
    ("stiffness", "duration", "rtol"), [("1e7", 3.0, 1e-7), ("3e5", 10.0, 2e-5), ("3e5", 9.0, 1e-4)]
)
def test_radau_is_kept_if_the_rest_of_its_steps_costs_less(examples, stiffness, duration, rtol):
    """A vibration has almost decayed when the trial has lost what it may: 12 to 65 steps remain of 200 to 280."""
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", stiffness), ("zeta", "0.01")])
    assert stiffmbs.run(scene, solver="auto", duration=duration, rtol=rtol).solver["name"] == "radau"


def test_steps_up_to_the_decay_of_a_vibration():
    """Nothing is seen of a vibration within a tolerance; e tolerances decay in 40 radians, if the run has as many."""
    assert steps_of_decay(1.0, 0.0, 100.0) == 0.0
    assert steps_of_decay(2.0, 0.0, 100.0) == pytest.approx(100.0 * AUTO.steps_per_radian)
    assert steps_of_decay(np.e, 0.025, 100.0) == pytest.approx(40.0 * AUTO.steps_per_radian)


@pytest.mark.long
def test_explicit_steps_are_not_taken_to_be_longer_than_those_of_radau(examples):
    """A rough road limits the steps of both, and the fastest rate does not tell."""
    road = examples / "vehicles" / "quarter_car.yaml"
    assert stiffmbs.run(road, solver="auto", rtol=1e-4).solver["name"] == "radau"


@pytest.mark.long
def test_checks_of_implicit_steps_are_spaced_in_proportion_to_the_steps_taken(examples, monkeypatch):
    """Each returns from compiled code and costs as much as several steps; 2000 steps have 15, and 10 or 24 at half or twice their density."""
    checks, wait = [], auto.ImplicitCheck._wait
    monkeypatch.setattr(auto.ImplicitCheck, "_wait", lambda check: checks.append(1) or wait(check))
    stiffmbs.run(examples / "vehicles" / "quarter_car.yaml", solver="auto", rtol=1e-4)
    assert 13 <= len(checks) <= 18


@pytest.mark.long
def test_radau_comes_back_where_explicit_steps_cost_more_than_its_own_had(examples):
    """Explicit steps over a rough road evaluate its height often, which the model of their cost does not tell."""
    road = examples / "vehicles" / "quarter_car.yaml"
    solution = stiffmbs.run(road, solver="auto", rtol=1e-6)
    (note,) = (note for note in solution.notes if note.startswith("auto chose"))
    assert "(explicit steps cost more)" in note
    assert solution.solver["steps"] > 0.8 * stiffmbs.run(road, solver="radau", rtol=1e-6).solver["steps"]


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(("stiffness", "zeta"), [("1e6", "0.05"), ("3e6", "0.01")])
def test_a_car_whose_start_excites_vibrations_keeps_explicit_steps(stiffness, zeta):
    """The stiff bushings do not carry the weight at the start; radau takes 3 and 5 times as long for the first second."""
    car = CARS[0]
    model = car.model("sweep", **{car.stiffness: stiffness, "zeta": zeta})
    assert stiffmbs.run(model, solver="auto", duration=1.0, rtol=1e-3).solver["name"] == "projected"


@pytest.mark.parametrize(("rtol", "name"), [(1e-3, "radau"), (1e-6, "projected")])
def test_radau_is_tried_sooner_at_a_loose_tolerance(examples, rtol, name):
    """Its steps are longer there, and those that stability holds back are not: 0.7 and 1.3 times as long as explicit ones take."""
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e6")])
    assert stiffmbs.run(scene, solver="auto", rtol=rtol).solver["name"] == name


@pytest.mark.parametrize(
    ("damping_ratio", "run_length", "name"),
    [(0.9, 1.0, "radau"), (1.5, 2.9, "bdf"), (np.inf, 2.9, "bdf"), (1.5, 3.1, "radau")],
)
def test_bdf_is_taken_for_overdamped_motions_in_short_runs(damping_ratio, run_length, name):
    assert implicit_solver(damping_ratio, run_length) == name


@pytest.mark.parametrize("name", ["dzhanibekov", "heavy_top"])
def test_a_few_explicit_steps_are_not_left_to_a_trial(examples, name):
    """Stability allows a rotation of about one turn in a step: all of them cost less than a start of implicit steps."""
    assert stiffmbs.run(examples / f"{name}.yaml", solver="auto", rtol=1e-3).solver["name"] == "projected"


@pytest.mark.parametrize(
    ("zeta", "duration", "name"), [("0.01", 1.0, "radau"), ("2", 1.0, "radau"), ("2", 0.01, "bdf")]
)
def test_the_stiffest_vibration_and_the_length_of_a_run_decide(examples, zeta, duration, name):
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e9"), ("zeta", zeta)])
    assert stiffmbs.run(scene, solver="auto", duration=duration, rtol=1e-3).solver["name"] == name


@pytest.mark.long
def test_output_points_of_the_last_explicit_step_are_kept_where_hands_change():
    model = stiffening(0.3)
    solution = stiffmbs.run(model, solver="auto", duration=1.5, output=1e-6, rtol=1e-4)
    assert solution.solver["name"] == "projected, radau"
    np.testing.assert_allclose(np.diff(solution.time), 1e-6, rtol=1e-6)


@pytest.mark.long
def test_a_car_leaves_bdf_for_the_bump_and_takes_it_again(examples):
    """Corners of the road shorten the steps of bdf and of dop853: bdf alone takes 1496 steps, dop853 takes 696 and 1.3 times as long."""
    scene = stiffmbs.load_scene(examples / "car.yaml", [("choose.compliance", "rigid"), ("choose.manoeuvre", "bump")])
    solution = stiffmbs.run(scene, solver="auto", rtol=1e-6)
    assert solution.solver["events"] > 10
    assert solution.solver["name"] == "bdf, projected"
    assert solution.solver["steps"] < 1000
