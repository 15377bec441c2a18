"""Runs state their energy balance, and what breaks it or diverges is told; runs that are right have no note."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import solve_ivp
from scipy.special import ellipk

import stiffmbs
from stiffmbs import AppliedForce, Body, Marker, Model, Prismatic, Revolute, SpringDamper
from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.commands.main import main
from stiffmbs.compile.compile_model import compile_model
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.results.energy_balance import Balance, balance_of_steps
from stiffmbs.show.report import report_page
from stiffmbs.solve.events.refusals import exponential
from tests.solve.radau.test_prescribed import CRANK

from ..conftest import EXAMPLES

TORSION = """
gravity: [0, -9.81]
bodies: {bar: {mass: 2, inertia: 0.1, position: [0.5, 0]}}
joints: {hinge: {type: revolute, i: {body: bar, point: [-0.5, 0]}, j: ground}}
forces: {s: {type: torsion_spring, i: bar, j: ground, stiffness: -200}}
run: {duration: 1.2 s}
"""

WITHOUT_ELEMENTS = SimpleNamespace(keeps_energy=False, groups=())


def sled(**spring):
    model = Model("Sled")
    model.add("sled", Body(mass=2, inertia=0.1, position=(1.3, 0)))
    model.add("rail", Prismatic(i="sled", j="ground"))
    post = Marker(body="ground", point=(-1, 0))
    model.add("spring", SpringDamper(i="sled", j=post, stiffness=50, free_length=2, **spring))
    return model


@pytest.mark.parametrize(
    ("name", "keeps"),
    [("cart_pendulum", True), ("andrews", True), ("heavy_top", True), ("bouncing_ball", False), ("door", False),
     ("half_car", False), ("crank_slider", False), ("stick_slip", False)],
)  # fmt: skip
def test_a_scene_keeps_energy_where_nothing_takes_or_gives_it(name, keeps):
    assert compile_model(stiffmbs.load_scene(EXAMPLES / f"{name}.yaml")).keeps_energy is keeps


def test_a_damper_of_zero_keeps_energy_and_one_above_does_not():
    assert compile_model(sled()).keeps_energy
    assert compile_model(sled(damping=0.0)).keeps_energy
    assert not compile_model(sled(damping=1.0)).keeps_energy
    assert not compile_model(sled(damper_law="v^3")).keeps_energy
    assert not compile_model(sled(spring_law="sin(s)^2")).keeps_energy


def test_a_contact_keeps_energy_without_dissipation_alone():
    model = Model(gravity=(0, -9.81))
    model.add("ball", Body(mass=1, inertia=1, position=(0, 1)))
    model.add("floor", FORCES["contact"](i="ball", j="ground", stiffness=1e6))
    assert compile_model(model).keeps_energy
    model.add("wall", FORCES["contact"](i="ball", j="ground", stiffness=1e6, dissipation=1.0))
    assert not compile_model(model).keeps_energy


def test_the_work_of_a_damper_is_what_is_lost():
    solution = stiffmbs.run(sled(damping=3.0), duration=3.0, rtol=1e-9)
    total = solution["energy.total"]
    assert solution.balance.work[-1] == pytest.approx(total[-1] - total[0], rel=1e-6)
    assert solution.balance.imbalance < 1e-6 * solution.balance.scale
    assert solution.notes == ()


def test_the_work_of_a_drive_lifts_a_weight():
    model = Model(gravity=(0, -9.81))
    model.add("cabin", Body(mass=3, inertia=1, angle=np.pi / 2))
    model.add("rail", Prismatic(i="cabin", j=Marker(body="ground", angle=np.pi / 2)))
    model.add("motor", JOINTS["drive"](joint="rail", position="t^2*(3 - 2*t)"))
    solution = stiffmbs.run(model, duration=1.0)
    assert solution.balance.work[-1] == pytest.approx(3 * 9.81, rel=1e-6)


def test_the_balance_is_in_the_summary_and_in_json(tmp_path):
    scene = str(EXAMPLES / "door.yaml")
    told = CliRunner().invoke(main, ["run", scene, "-o", str(tmp_path / "a.npz")]).stdout
    assert "non-conservative work" in " ".join(told.split())
    line = CliRunner().invoke(main, ["run", scene, "--json", "-o", str(tmp_path / "a.npz")]).stdout
    balance = json.loads(line)["balance"]
    assert balance["work"] == pytest.approx(balance["change"], rel=1e-4) and not balance["conservative"]


@pytest.mark.long
def test_an_energy_that_changes_where_nothing_acts_is_told():
    solution = stiffmbs.run(sled(), duration=3.0, solver="projected", scheme="euler_cromer", step=0.1, output=0.1)
    assert any("energy balance is broken" in note for note in solution.notes)


VIBRATION = """
bodies: {b: {mass: 2, inertia: 1, position: [0.1, 0]}}
joints: {r: {type: prismatic, i: b, j: ground}}
forces: {s: {type: force, i: b, force: ["-50*b.x - 0.4*b.vx + 3*sin(3.3*t)", 0]}}
run: {duration: 20, rtol: 1.0e-6}
"""


def work_of_vibration(t_end):
    """Work of all forces but the spring's, J, by an own integration with the work as a state."""
    found = solve_ivp(
        lambda t, y: [y[1], -25 * y[0] - 0.2 * y[1] + 1.5 * np.sin(3.3 * t), (3 * np.sin(3.3 * t) - 0.4 * y[1] - 50 * y[0]) * y[1]],
        (0, t_end), [0.1, 0, 0], method="DOP853", rtol=1e-11, atol=1e-13,
    )  # fmt: skip
    return found.y[2, -1]


@pytest.mark.sampled(5)
@pytest.mark.parametrize("solver", ["bdf", "radau", "projected", "auto"])
@pytest.mark.parametrize("points", [2, 5, 33, 1001])
def test_the_work_does_not_depend_on_output_times(solver, points):
    """Steps of radau and dop853 span a quarter of a period, and two output times know nothing of the vibration."""
    solution = stiffmbs.run(stiffmbs.read_scene(VIBRATION), solver=solver, points=points)
    balance = solution.balance
    assert solution.notes == () or all("chose" in note for note in solution.notes)
    within = 1e-3 if balance.resolved else 1e-2
    assert balance.work[-1] == pytest.approx(work_of_vibration(20.0), abs=within * balance.scale)
    assert balance.imbalance < within * balance.scale


@pytest.mark.parametrize("solver", ["bdf", "radau", "projected"])
def test_the_work_of_a_force_that_jumps(solver):
    """A square wave on a damped mass, v' = 10 s - v in closed form between the jumps: its steps begin at rounding of time."""
    scene = """
bodies: {b: {mass: 1, inertia: 1}}
joints: {r: {type: prismatic, i: b, j: ground}}
forces: {f: {type: force, i: b, force: ["10*sign(sin(9*t)) - b.vx", 0]}}
run: {duration: 10, points: 4, rtol: 1.0e-6}
"""
    balance = stiffmbs.run(stiffmbs.read_scene(scene), solver=solver).balance
    v, t, sign = 0.0, 0.0, 1.0
    while t < 10:
        end = min(t + np.pi / 9, 10.0)
        v, t, sign = 10 * sign + (v - 10 * sign) * np.exp(t - end), end, -sign
    assert balance.resolved
    assert balance.work[-1] == pytest.approx(v**2 / 2, abs=1e-4 * balance.scale)
    assert balance.imbalance < 1e-4 * balance.scale


def test_work_that_steps_miss_is_told():
    """A run whose steps do not contain the force of a bump: its rows do."""
    rows = SimpleNamespace(
        t=np.array([0.0, 0.5, 1.0, 1.0, 1.5, 2.0]), kinetic=np.full(6, 2.0), potential=np.zeros(6),
        power=np.array([0.0, 0.0, 0.0, 0.0, 3.0, 0.0]), values=np.empty((6, 0)),
    )  # fmt: skip
    weights = np.array([[1.0, 4.0, 1.0], [1.0, 4.0, 1.0]]) / 6
    found = balance_of_steps(WITHOUT_ELEMENTS, rows, weights, np.zeros(1, dtype=bool))
    assert found.work.tolist() == [0.0, 2.0] and found.imbalance == 2.0 and found.scale == 2.0


def test_what_a_prescribed_jump_of_velocities_changes_is_no_work():
    rows = SimpleNamespace(
        t=np.array([0.0, 0.5, 1.0, 1.0, 1.5, 2.0]),
        kinetic=np.array([1.0, 1, 1, 4, 4, 4]),
        potential=np.zeros(6),
        power=np.zeros(6),
        values=np.empty((6, 0)),
    )
    weights = np.full((2, 3), 1 / 3)
    assert balance_of_steps(WITHOUT_ELEMENTS, rows, weights, np.ones(1, dtype=bool)).imbalance == 0.0
    assert balance_of_steps(WITHOUT_ELEMENTS, rows, weights, np.zeros(1, dtype=bool)).imbalance == 3.0


def test_the_energy_of_each_element_over_an_oscillation(tmp_path):
    """A mass on a damped spring, pulled by a force that changes its sign: m x'' + c x' + k x = F cos(w t)."""
    mass, damping, stiffness, force, rate, end = 2.0, 3.0, 50.0, 7.0, 4.0, 2.3
    model = sled(damping=damping)
    model.add("pull", AppliedForce(i="sled", force=(f"{force}*cos({rate}*t)", 0)))
    found = stiffmbs.run(model, duration=end, points=2001, rtol=1e-9)

    def rates(t, y):
        x, v, _, _, _ = y
        pull = force * np.cos(rate * t)
        power = pull * v
        return v, (pull - damping * v - stiffness * x) / mass, damping * v * v, max(power, 0.0), max(-power, 0.0)

    x, _, lost, driven, held = solve_ivp(rates, (0, end), [0.3, 0, 0, 0, 0], rtol=1e-10, atol=1e-12).y[:, -1]
    energies = found.balance.elements
    assert energies["spring"].stored == pytest.approx(stiffness * (x**2 - 0.3**2) / 2, rel=1e-6)
    assert energies["spring"].dissipated == pytest.approx(lost, rel=1e-5) and energies["spring"].supplied == 0.0
    assert energies["pull"].supplied == pytest.approx(driven, rel=1e-4)
    assert energies["pull"].dissipated == pytest.approx(held, rel=1e-4)
    found.save(tmp_path / "run.npz")
    assert stiffmbs.Solution.load(tmp_path / "run.npz").balance.elements == energies


@pytest.mark.parametrize(
    "example",
    [
        "andrews",
        "door",
        "governor",
        "vehicles/quarter_car",
        "spatial_slider_crank",
        "beams/cable",
        "flexible/robot_arm",
    ],
)
def test_energies_of_the_elements_add_up_to_the_balance(example):
    found = stiffmbs.run(EXAMPLES / f"{example}.yaml", duration=0.05)
    balance, energies = found.balance, found.balance.elements.values()
    change = found["energy.potential"][-1] - found["energy.potential"][0]
    assert sum(each.stored for each in energies) == pytest.approx(change, abs=1e-9 * balance.scale)
    work = sum(each.supplied - each.dissipated for each in energies)
    assert work == pytest.approx(balance.work[-1], abs=1e-3 * balance.scale)
    assert all(each.supplied >= 0 and each.dissipated >= 0 for each in energies)


@pytest.mark.parametrize("points", [61, 64, 71])
def test_a_motor_that_drives_and_brakes_in_turn(points):
    """Inertia 0.1 with the angle sin(3 t): 0.45 J are supplied, and taken back, in each of six quarters of two turns."""
    model = Model()
    model.add("rotor", Body(mass=1, inertia=0.1))
    model.add("pin", JOINTS["revolute"](i="rotor", j="ground"))
    model.add("motor", JOINTS["drive"](joint="pin", position="sin(3*t)"))
    found = stiffmbs.run(model, duration=2 * np.pi, points=points, rtol=1e-8).balance
    assert not found.within_steps
    energy = found.elements["motor"]
    assert energy.supplied == pytest.approx(2.7, rel=5e-3) and energy.dissipated == pytest.approx(2.7, rel=5e-3)


def test_a_drive_that_stops_dead_breaks_no_balance():
    model = sled(damping=2.0)
    model.add("motor", JOINTS["drive"](joint="rail", position="0.3*min(t, 1)"))
    for solver in ("bdf", "radau", "projected"):
        solution = stiffmbs.run(model, duration=2.0, points=4, solver=solver, rtol=1e-7)
        assert not any("broken" in note for note in solution.notes)
        assert solution.balance.imbalance < 1e-2 * solution.balance.scale


@pytest.mark.parametrize("power", [1, 2, 4])
def test_powers_of_time_are_no_exponential_growth(power):
    t = np.linspace(0, 10, 2001)
    assert not exponential(t, t**power)
    assert not exponential(t, np.maximum(t - 5, 0) ** power)
    assert exponential(t, np.exp(2 * t))


@pytest.mark.long
def test_a_spring_of_wrong_sign_is_told_and_named():
    solution = stiffmbs.run(stiffmbs.read_scene(TORSION))
    (told,) = (words for words in (solution.message, *solution.notes) if "diverges" in words)
    assert "'bar'" in told


def test_a_spring_of_wrong_sign_that_is_solved_to_the_end_is_told_and_named():
    model = Model()
    model.add("block", Body(mass=1, inertia=1, position=(0.5, 0)))
    model.add("spring", SpringDamper(i="block", j="ground", stiffness=-100, free_length=0.4))
    solution = stiffmbs.run(model, duration=2.6)
    (note,) = (note for note in solution.notes if "diverges" in note)
    assert "'block'" in note and "'spring'" in note


@pytest.mark.long
def test_a_report_of_a_diverged_run_has_no_all_clear():
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    scene = stiffmbs.read_scene(TORSION)
    page = report_page(scene, stiffmbs.run(scene)).lower()
    assert "diverges" in page and "no problems found" not in page


SPRING_THAT_PUSHES = """
dimensions: 3
gravity: [0, 0, 0]
bodies:
  a: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}
  b: {mass: 1, inertia: [1, 1, 1], position: [2, 0, 0]}
joints: {pin: {type: revolute, i: a, j: ground}}
forces:
  counted: {type: torsion_spring, i: a, j: ground, stiffness: 1}
  wrong: {type: spring_damper, i: b, j: ground, stiffness: -1e4, free_length: 0.5}
run: {duration: 2, solver: projected}
"""


def test_a_motion_diverges_next_to_counted_revolutions():
    """The counter after the coordinates of the bodies ended the run with an error of NumPy."""
    found = stiffmbs.run(stiffmbs.read_scene(SPRING_THAT_PUSHES))
    assert "the motion diverges" in found.message and "'b'" in found.message and "'wrong'" in found.message


def test_constraints_that_drift_apart_are_told():
    scene = stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml")
    solution = stiffmbs.run(
        scene, solver="projected", scheme="euler_cromer", projection=False, step=0.02, duration=3.0, output=0.02
    )
    assert any("joint 'hinge'" in note and "has an error of" in note for note in solution.notes)


def test_a_request_without_a_value_is_told():
    model = sled()
    model.request("root", "sqrt(sled.x - 1)")
    solution = stiffmbs.run(model, duration=3.0)
    assert any("root is not finite" in note for note in solution.notes)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
@pytest.mark.parametrize("name", ["bouncing_ball", "elastic_bearing", "half_car", "chain", "bar_pendulum"])
def test_examples_have_no_note_of_balance_or_growth(name, solver):
    solution = stiffmbs.run(stiffmbs.load_scene(EXAMPLES / f"{name}.yaml"), solver=solver)
    assert [note for note in solution.notes if not note.startswith("the estimated error of")] == []


def test_the_imbalance_is_that_of_all_instants_and_intervals():
    t, none = np.arange(4.0), np.zeros(4)
    small = np.array([0.0, 1e-3, -2e-3, 0.0])
    assert Balance(t, small, none, 1.0, True).imbalance == pytest.approx(3e-3)
    assert Balance(t, none, none, 1.0, True).imbalance == 0.0


def test_a_scene_that_keeps_energy_needs_no_work():
    balance = stiffmbs.run(sled(), duration=1.0, points=11).balance
    assert balance.resolved and not balance.work.any()


@pytest.mark.long
def test_the_spring_of_wrong_sign_is_named_among_others_of_its_kind():
    text = TORSION.replace("-200}", "-200, damping: 0}").replace(
        "forces: {", "forces: {a: {type: torsion_spring, i: bar, j: ground, stiffness: 3}, "
    )
    solution = stiffmbs.run(stiffmbs.read_scene(text))
    (note,) = [note for note in solution.notes if "negative" in note or "'s'" in note]
    assert "'s'" in note and "'a'" not in note


def test_the_error_of_a_loose_tolerance_is_no_broken_balance():
    """bdf damps a vibration of 30 periods by a fifth."""
    text = "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1, position: [2, 0]}}\njoints: {rail: {type: prismatic, i: b, j: ground}}\n"
    text += (
        "forces: {s: {type: spring_damper, i: b, j: ground, stiffness: 39.5, free_length: 1}}\nrun: {duration: 30}\n"
    )
    found = stiffmbs.run(stiffmbs.read_scene(text), solver="bdf", rtol=1e-2)
    assert np.ptp(found["energy.total"]) > 0.1 * found["energy.total"][0]
    assert not any("broken" in note for note in found.notes)


@pytest.mark.parametrize(
    ("solver", "rtol", "periods"),
    [("bdf", 1e-4, 20), ("bdf", 1e-6, 200), ("radau", 1e-4, 200), ("projected", 1e-6, 200)],
)
@pytest.mark.parametrize("per_period", [1, 2])
def test_turning_points_alone_do_not_break_the_balance(solver, rtol, periods, per_period):
    """There is no kinetic energy at any output time: an error of 2e-5 of that in between was called all of it."""
    angle, arm, inertia = 1.2, 0.5, 1e-3
    period = 4 * ellipk(np.sin(angle / 2) ** 2) * np.sqrt((inertia + arm**2) / (9.81 * arm))
    bar = f"{{mass: 1, inertia: {inertia}, position: [{arm}*sin({angle}), -{arm}*cos({angle})], angle: {angle}}}"
    text = f"gravity: [0, -9.81]\nbodies: {{bar: {bar}}}\njoints: {{hinge: {{type: revolute, i: ground, j: {{body: bar, point: [0, {arm}]}}}}}}\n"
    grid = {"duration": periods * period, "output": period / per_period}
    found = stiffmbs.run(stiffmbs.read_scene(text), solver=solver, rtol=rtol, **grid)
    assert found["energy.kinetic"].max() < 0.1 * 9.81 * arm * (1 - np.cos(angle))
    assert not any("broken" in note for note in found.notes)


@pytest.mark.parametrize("omega", [0, 1e3, 1e6])
def test_growth_names_the_body_that_grows_and_not_the_fastest(omega):
    """A block runs away as cosh(t); a wheel of the same mechanism spins evenly."""
    scene = stiffmbs.read_scene(f"""
bodies:
  wheel: {{mass: 1, inertia: 1, omega: {omega}}}
  block: {{mass: 1, inertia: 1, position: [1, 0]}}
joints: {{axle: {{type: revolute, i: wheel, j: ground}}}}
forces: {{spring: {{type: spring_damper, i: block, j: ground, stiffness: -1, free_length: 0.9}}}}
run: {{duration: 30, points: 41, rtol: 1e-4}}
""")
    solution = stiffmbs.run(scene, solver="projected", scheme="dop853")
    (note,) = (note for note in solution.notes if "diverges" in note)
    assert "at t = 12.75 s 'block' exceeds 1e+04 times" in note


@pytest.mark.long
def test_the_balance_is_that_of_the_run_with_the_solver_that_auto_chose():
    """For the first part of a run of 5 s, `auto` chooses explicit steps: after many impacts the states are others."""
    scene = load_scene(EXAMPLES / "cam_follower.yaml")
    found = stiffmbs.run(scene, solver="auto", duration=5, points=5001, output=None, errors=False)
    assert "auto chose radau" in found.notes[0] and not any("energy balance" in note for note in found.notes)


def test_the_balance_of_a_run_repeated_with_exact_constraints_is_that_of_its_steps():
    scene = stiffmbs.read_scene(CRANK.replace("20*t", "1000*t").replace("duration: 20", "duration: 0.4"))
    found = stiffmbs.run(scene, rtol=1e-6, presolve=False, solver="bdf")
    assert any("repeated with formulation SI2_exact" in note for note in found.notes)
    assert not any("energy balance" in note for note in found.notes)


BY_SAMPLES = """
gravity: [0, 0]
bodies: {cart: {mass: 3, inertia: 1}, slider: {mass: 1, inertia: 1}}
states: {u: {update: "sin(3*t)", period: 0.07}}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  guide: {type: prismatic, i: slider, j: cart}
  drive: {type: drive, joint: guide, velocity: "u"}
forces: {s: {type: force, i: cart, force: ["-300*cart.x - 5*cart.vx", 0]}}
run: {duration: 1, points: 41}
"""
BY_A_KINK = """
bodies: {b: {mass: 1, inertia: 1}}
joints: {r: {type: prismatic, i: b, j: ground}, d: {type: drive, joint: r, position: "SPEED*min(t, 1)"}}
run: {duration: 2, points: 201}
"""
WITH_STEPS = [{"solver": "bdf"}, {"solver": "radau"}, {"solver": "projected", "scheme": "dop853"}]


@pytest.mark.parametrize("rtol", [1e-3, 1e-5])
@pytest.mark.parametrize("solver", WITH_STEPS)
def test_jumps_of_a_sampled_drive_are_no_work(solver: dict[str, str], rtol: float) -> None:
    """The balance took states before a sample for those after it, and jumps of less than 100 tolerances for work."""
    found = stiffmbs.run(stiffmbs.read_scene(BY_SAMPLES), rtol=rtol, errors=False, **solver)
    assert found.success and not any("energy balance" in note for note in found.notes)
    assert found.balance.imbalance < 0.01 * found.balance.scale


@pytest.mark.parametrize("speed", [5e-5, 5e-7])
@pytest.mark.parametrize("solver", WITH_STEPS)
def test_a_jump_of_a_drive_of_any_size_is_no_work(solver: dict[str, str], speed: float) -> None:
    found = stiffmbs.run(stiffmbs.read_scene(BY_A_KINK.replace("SPEED", str(speed))), errors=False, **solver)
    assert not any("energy balance" in note for note in found.notes)
    assert found.balance.scale == pytest.approx(0.5 * speed**2)


def test_rounding_of_a_mechanism_at_rest_is_no_energy() -> None:
    """The positions of I3, divided by short steps, give velocities of 1e-60 m/s, and a doubt about 1e-56 J."""
    model = Model(gravity=(0, 0))
    model.add("b", Body(mass=1, inertia=0.1, position=(0.3, 0)))
    model.add("a", Body(mass=1, inertia=0.1, position=(0.6, 0)))
    model.add("h", Revolute(i="b", j="ground"))
    model.add("k", Revolute(i=Marker(body="a", point=(0.3, 0)), j="b"))
    model.add("f", AppliedForce(i="a", force=(0, "max(-a.vy, 0)")))
    found = model.run(duration=0.2, points=2, formulation="I3", rtol=1e-9, presolve=False)
    assert found.message == "completed"
