"""Springs and applied forces against closed forms and conservation laws."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import (
    AppliedForce,
    AppliedTorque,
    Body,
    Bushing,
    InputError,
    JointFriction,
    Marker,
    Model,
    Prismatic,
    Revolute,
    SpringDamper,
    TorsionSpring,
    compile_model,
)
from stiffmbs.compile.state import State

from ..closed_forms import momenta, oscillation, two_bodies
from .test_element_derivatives import assert_close, derivative, term

FINE = {"rtol": 1e-10, "points": 101}


def mass_on_spring(start=(1.3, 0.0), velocity=(0.0, 0.0), **spring):
    model = Model()
    model.add("ball", Body(mass=2, inertia=1, position=start, velocity=velocity))
    model.add("spring", SpringDamper(i="ball", j="ground", free_length=1, **spring))
    return model


# springs


@pytest.mark.parametrize("law", ["80*s", {"table": [[-1, -80], [1, 80]]}, {"table": [[0, 0], [1, 80]], "lines": True}])
def test_straight_curves_are_a_linear_spring_and_damper(law):
    damper = {"table": [[-1, -3], [0, 0], [2, 6]], "lines": True}
    solution = stiffmbs.run(mass_on_spring(spring_law=law, damper_law=damper), duration=2, **FINE)
    omega = np.sqrt(80 / 2)
    expected = 1 + oscillation(solution.time, 0.3, omega, 3 / (2 * 2 * omega))
    np.testing.assert_allclose(solution["ball.x"], expected, atol=1e-7)


CURVES = {
    "cubic": "50*s + 4000*s^3 - 7*s^2 + 3",
    "spline": {"table": [[-0.2, -50], [-0.05, -2], [0, 1], [0.1, 20], [0.15, 70]]},
    "lines": {"table": [[-0.2, -50], [-0.05, -2], [0, 1], [0.1, 20], [0.15, 70]], "lines": True},
    "periodic": {"table": [[0, 1], [0.05, 30], [0.1, -20], [0.13, 1]], "ends": "periodic"},
}


@pytest.mark.parametrize("law", CURVES.values(), ids=CURVES.keys())
def test_energy_is_kept_by_curves_within_and_beyond_their_points(law):
    model = mass_on_spring(start=(1.3, 0.2), velocity=(0.2, 1.0), stiffness=100, preload=5, spring_law=law)
    solution = stiffmbs.run(model, duration=2, **FINE)
    deflection = np.hypot(solution["ball.x"], solution["ball.y"]) - 1
    assert deflection.min() < -0.2 and deflection.max() > 0.15
    assert solution.energy_drift() < 2e-6 * solution["energy.kinetic"].max()


def test_a_cubic_spring_passes_its_free_length_with_the_speed_of_its_potential():
    solution = stiffmbs.run(mass_on_spring(spring_law="4000*s^3"), duration=1, rtol=1e-10, points=2001)
    assert np.abs(solution["ball.vx"]).max() == pytest.approx(np.sqrt(2 / 2 * 1000 * 0.3**4), rel=1e-5)


def test_a_law_without_simple_integral_leaves_the_element_without_potential():
    solution = stiffmbs.run(mass_on_spring(stiffness=10, spring_law="100*tanh(s/0.1)"), duration=0.1, points=3)
    assert np.all(solution["energy.potential"] == 0)
    assert solution["spring.fx"][0] == pytest.approx(-3 - 100 * np.tanh(3), rel=1e-12)


def pinned_disc(**spring):
    model = Model()
    model.add("disc", Body(mass=1, inertia=0.5, angle=0.8))
    model.add("pin", Revolute(i="disc", j="ground"))
    model.add("spring", TorsionSpring(i="disc", j=Marker(body="ground", angle=0.2), **spring))
    return model


def test_torsion_oscillator():
    """About the angle where spring and preload balance: ground marker 0.2, free angle 0.3, preload -1.2 N m / 8."""
    model = pinned_disc(stiffness="8 N m/rad", damping="0.4 N m s/rad", free_angle=0.3, preload=-1.2)
    solution = stiffmbs.run(model, duration=3, **FINE)
    rest = 0.2 + 0.3 + 1.2 / 8
    expected = rest + oscillation(solution.time, 0.8 - rest, 4.0, 0.4 / (2 * 0.5 * 4))
    np.testing.assert_allclose(solution["disc.angle"], expected, atol=1e-8)
    np.testing.assert_allclose(solution["spring.torque"], 0.5 * solution["disc.alpha"], atol=1e-12)


def test_torsion_spring_by_curves():
    solution = stiffmbs.run(pinned_disc(stiffness=1, spring_law="5*s^3 - s", damper_law="0*v"), duration=3, **FINE)
    assert solution.energy_drift() < 1e-8
    assert solution["energy.potential"][0] == pytest.approx(5 / 4 * 0.6**4, rel=1e-12)


FULL = {
    "stiffness": [[50, 12, -3], [12, 80, 4.5], [-3, 4.5, 9]], "damping": [[1, 0.2, 0], [0.2, 2, 0.1], [0, 0.1, 0.2]], "preload": (3, -2, 1),
    "law_x": "500*s^3", "law_y": {"table": [[-1, -40], [0, 3], [1, 20]]}, "law_angle": "2*sin(s)",
}  # fmt: skip
SPRING = {"stiffness": 30, "damping": 0.4, "free_length": 0.3, "damper_law": "v^3", "spring_law": "sin(s)"}


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("element", "fields"),
    [
        (SpringDamper, SPRING),
        (TorsionSpring, {"stiffness": 3, "damping": 0.2, "spring_law": "s^3", "preload": 1}),
        (Bushing, FULL),
        (AppliedForce, {"force": ("10*sin(3*t)", "4 - 2*vx(a, b)"), "axes": "body"}),
        (AppliedForce, {"force": (3, "-20*dy(a, b)")}),
        (AppliedTorque, {"torque": "1 - wz(a, b)"}),
    ],
    ids=lambda part: part.__name__ if isinstance(part, type) else "",
)
def test_forces_between_bodies_keep_momentum_and_angular_momentum(element, fields):
    model = two_bodies(element, **fields)
    solution = stiffmbs.run(model, duration=1, **FINE)
    assert np.ptp(solution["a.omega"]) > 0.1
    for momentum in momenta(model, solution):
        assert np.ptp(momentum) < 1e-7


# applied forces


def test_aerodynamic_drag_by_formula():
    """m v' = -c v^2 gives v = v0/(1 + c v0 t/m), on a straight line whatever its direction; at rest nothing happens."""
    drag = ("-0.3*vm(ball)*vx(ball)", "-0.3*vm(ball)*vy(ball)")
    for speed in (20.0, 0.0):
        model = Model()
        model.add("ball", Body(mass=2, inertia=1, velocity=(0.6 * speed, 0.8 * speed)))
        model.add("drag", AppliedForce(i="ball", force=drag))
        solution = stiffmbs.run(model, duration=3, **FINE)
        expected = speed / (1 + 0.3 * speed * solution.time / 2)
        np.testing.assert_allclose(solution["ball.vx"], 0.6 * expected, atol=1e-7)
        np.testing.assert_allclose(solution["ball.vy"], 0.8 * expected, atol=1e-7)


def test_a_force_in_body_axes_turns_with_the_body():
    model = Model()
    model.add("rocket", Body(mass=2, inertia=1, omega=3))
    model.add("thrust", AppliedForce(i="rocket", force=(5, 0), axes="body"))
    solution = stiffmbs.run(model, duration=2, **FINE)
    np.testing.assert_allclose(solution["rocket.vx"], 5 / 2 / 3 * np.sin(3 * solution.time), atol=1e-8)
    np.testing.assert_allclose(solution["rocket.vy"], 5 / 2 / 3 * (1 - np.cos(3 * solution.time)), atol=1e-8)


def test_a_motor_with_a_falling_torque_reaches_its_speed():
    model = Model()
    model.add("rotor", Body(mass=1, inertia=0.2))
    model.add("pin", Revolute(i="rotor", j="ground"))
    model.add("motor", AppliedTorque(i="rotor", torque="3 - 0.5*wz(rotor)"))
    solution = stiffmbs.run(model, duration=2, **FINE)
    np.testing.assert_allclose(solution["rotor.omega"], 6 * (1 - np.exp(-0.5 / 0.2 * solution.time)), atol=1e-8)


def test_constant_forces_have_a_potential():
    model = Model()
    model.add("ball", Body(mass=2, inertia=1, velocity=(1, 2), omega=1))
    model.add("force", AppliedForce(i=Marker(body="ball", point=(0.3, 0.1)), force=(3, -7)))
    model.add("torque", AppliedTorque(i="ball", torque=0.5))
    solution = stiffmbs.run(model, duration=1, **FINE)
    assert np.ptp(solution["energy.kinetic"]) > 5
    assert solution.energy_drift() < 1e-8


# what is refused

PAIR = {"i": "b", "j": "ground"}
REFUSED = [
    (SpringDamper, {"spring_law": "3*t"}, r"spring_law: found t in '3\*t', expected a formula without it"),
    (SpringDamper, {"damper_law": "3*s"}, r"damper_law: found the unknown name 's' in '3\*s', expected v"),
    (SpringDamper, {"spring_law": {"table": [[0, 1], [0, 2]]}}, "spring_law.table: found 0 after 0 in a table"),
    (TorsionSpring, {"stiffness": "3 N/m"}, "stiffness: found '3 N/m', .* expected a torsional stiffness in N m/rad"),
    (TorsionSpring, {"damping": "3 N s/m"}, "damping: found '3 N s/m', .* expected a torsional damping"),
    (Bushing, {"stiffness": 5}, "stiffness: found 5, expected a list"),
    (Bushing, {"stiffness": [1, 2]}, "stiffness: found 2 entries, expected 3, or 3 rows"),
    (Bushing, {"stiffness": [1, 2, "3 N"]}, "stiffness.2.2: found '3 N', .* expected a torsional stiffness"),
    (Bushing, {"damping": [[1, 0, 0], [0, 1, "1 N"], [0, 0, 1]]}, "damping.1.2: found '1 N', .* in N s/rad"),
    (Bushing, {"stiffness": [[1, 2, 0], [3, 1, 0], [0, 0, 1]]}, "found 2 in row 1, column 2 and 3 across .* symmetric"),
    (Bushing, {"axes": "i"}, "axes: found 'i', expected 'j' or 'ground'"),
    (Bushing, {"preload": (1, "2 m", 0)}, "preload.1: found '2 m', .* expected a force in N"),
    (AppliedTorque, {"torque": "spin(b)"}, r"torque: found the unknown function 'spin'"),
]


@pytest.mark.parametrize(("element", "fields", "sentence"), REFUSED)
def test_bad_input_is_refused_in_one_sentence(element, fields, sentence):
    with pytest.raises(InputError, match=sentence) as error:
        element(**PAIR, **fields)
    assert "\n" not in str(error.value)


def rubbing_guide():
    model = two_bodies(Prismatic)
    model.add(
        "rubbing", JointFriction(joint="element", friction=0.3, static_friction=0.4, length=0.2, stiction_velocity=2)
    )
    return model


VARIANTS = {
    "spring": two_bodies(SpringDamper, **SPRING),
    "torsion": two_bodies(TorsionSpring, stiffness=3, spring_law=CURVES["spline"], damper_law="sin(v)"),
    "bushing": two_bodies(Bushing, **FULL),
    "bushing, ground": two_bodies(Bushing, **FULL, axes="ground"),
    "force": two_bodies(AppliedForce, force=("sin(t)*dm(a, b)", "vr(a, b)"), axes="body"),
    "guide": rubbing_guide(),
}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("model", VARIANTS.values(), ids=VARIANTS.keys())
def test_derivatives_of_what_random_elements_leave_out(model):
    state = State(compile_model(model.data()))
    state.lam[:] = (1.3, -0.8)[: len(state.lam)]
    state.q[:2] += 1  # away from where a distance is strongly curved
    force = derivative(lambda: term(state, "motion", "f"), state.q)
    assert np.linalg.norm(force) > 0.1
    assert_close(term(state, "tangent", "f_q"), force)
    assert_close(term(state, "tangent", "f_u"), derivative(lambda: term(state, "motion", "f"), state.u))
    assert_close(term(state, "tangent", "f_lam"), derivative(lambda: term(state, "motion", "f"), state.lam))


@pytest.mark.parametrize("formula", ["1/0*t", "step(1, 1, 0, 1, 1)", "sqrt(-1)*t", "log(0) + t", "exp(1e4)*t"])
def test_a_constant_without_a_value_is_refused_by_name(formula):
    model = Model()
    model.add("ball", Body(mass=1, inertia=1))
    model.add("push", AppliedForce(i="ball", force=(formula, 0)))
    with pytest.raises(InputError, match=r"^push: found '.*', which has"):
        stiffmbs.run(model, duration=0.1)


def test_a_run_that_stops_names_the_body():
    """x'' = x^2 goes to infinity in a finite time; the other body has no part in it."""
    model = Model()
    model.add("idle", Body(mass=1, inertia=1))
    model.add("runaway", Body(mass=1, inertia=1, position=(1, 0), velocity=(1, 0)))
    model.add("push", AppliedForce(i="runaway", force=("runaway.x^2", 0)))
    solution = stiffmbs.run(model, duration=20.0, points=21)
    assert solution.outcome.name == "STOPPED"
    assert "largest error was in runaway.vx" in solution.message


@pytest.mark.parametrize("fields", [{"free_length": 1.0}, {"preload": 5.0}])
def test_a_spring_between_points_at_one_place_is_refused(fields):
    model = Model()
    model.add("mass", Body(mass=1, inertia=1))
    model.add("spring", SpringDamper(i="mass", j="ground", stiffness=10.0, **fields))
    with pytest.raises(
        InputError, match=r"forces.spring: found both of its points in the same place.*expected them apart"
    ):
        stiffmbs.run(model, duration=0.1)
    without = Model()
    without.add("mass", Body(mass=1, inertia=1))
    without.add("spring", SpringDamper(i="mass", j="ground", stiffness=10.0))
    assert stiffmbs.run(without, duration=0.1)["mass.x"][-1] == 0


@pytest.mark.parametrize("settings", [{}, {"solver": "projected", "scheme": "dop853"}], ids=["bdf", "dop853"])
def test_a_force_may_follow_the_magnitude_of_a_reaction(settings):
    """sqrt(fx^2 + fy^2) has no derivative where the first guess has no reaction: 0.1 m g on 1 kg."""
    scene = stiffmbs.read_scene("""
gravity: [0, -9.81]
bodies: {a: {mass: 2, inertia: 1}, b: {mass: 1, inertia: 1}}
joints: {rail: {type: prismatic, i: a, j: ground}}
forces: {f: {type: force, i: b, force: ["0.1*sqrt(fx(rail)^2 + fy(rail)^2)", 0]}}
run: {duration: 0.1, points: 3}
""")
    np.testing.assert_allclose(stiffmbs.run(scene, **settings)["b.ax"], 0.1 * 2 * 9.81, rtol=1e-9)
