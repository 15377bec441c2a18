"""Forces in space: what every one of them keeps, and closed forms."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import spatial
from stiffmbs.compile.state import State

from ..spatial_pairs import momenta, turned, two_bodies, wrenches
from .test_element_derivatives import assert_close, derivative, term

FINE = {"rtol": 1e-10, "points": 101}

_ROOT = np.random.default_rng(2).uniform(-1, 1, (6, 6))
FULL = (10 * _ROOT @ _ROOT.T + np.diag([50.0, 60, 70, 5, 6, 7])).tolist()
"""Symmetric, each component on all others."""
BLOCKS = [[row[3 * k : 3 * k + 3] for row in FULL[3 * k : 3 * k + 3]] for k in (0, 1)]
SIX = (50, 60, 70, 5, 6, 7)
SECTION = {
    "length": 0.8, "young": 2e3, "shear_modulus": 800, "area": 0.02, "torsion": 3e-3, "iyy": 1e-3, "izz": 2e-3,
    "asy": 1.2, "asz": 1.1,
}  # fmt: skip
NEAR = {"apart": (0.02, -0.03, 0.01)}

CLOSED = {
    "plane": {"apart": (0.3, -0.2, 0.15), "radius": 0.5, "stiffness": 50.0},
    "sphere": {"apart": (0.3, -0.2, 0.15), "surface": "sphere", "radius": 0.4, "surface_radius": 0.45, "stiffness": 50.0},
    "hollow": {"apart": (0.3, -0.2, 0.15), "surface": "hollow", "radius": 0.5, "surface_radius": 0.55, "stiffness": 50.0},
}  # fmt: skip
"""Contacts that are closed by some decimetres."""

INNER = {
    "spring_damper": (
        spatial.SpringDamper,
        {"stiffness": 30, "damping": 2, "free_length": 0.5, "preload": 3, "spring_law": "5*s^3"},
    ),
    "line_force": (spatial.LineForce, {"force": "3 - 20*(dm(a, b) - 0.5) - 2*vr(a, b)"}),
    "force": (spatial.AppliedForce, {"force": ("1 + a.x", "2*sin(t)", "-vz(b)")}),
    "force_in_axes_of_i": (spatial.AppliedForce, {"force": ("1 + a.x", "2*sin(t)", "-vz(b)"), "axes": "body"}),
    "force_in_axes_of_b": (spatial.AppliedForce, {"force": ("1 + a.x", "2*sin(t)", "-vz(b)"), "frame": "b"}),
    "bushing": (spatial.Bushing, {"stiffness": SIX, "damping": SIX, "preload": (1, 2, 3, 4, 5, 6)}),
    "coupled_bushing": (spatial.Bushing, {"stiffness": FULL, "damping": FULL}),
    "bushing_free_about_y": (spatial.Bushing, {"stiffness": (50, 60, 70, 5, 0, 7), "damping": SIX}),
    "bushing_by_laws": (spatial.Bushing, {"law_x": "1e3*s^3", "law_about_y": "2*sinh(s)", "damping": BLOCKS}),
    "field": (
        spatial.FieldForce,
        {"stiffness": FULL, "damping": FULL, "free": (0.7, -0.4, 0.5, 0.1, 0.2, 0.3), "preload": SIX},
    ),
    "beam": (spatial.Beam, SECTION | {"damping_ratio": 0.01}),
    **{
        f"{surface}_contact": (spatial.SphereContact, CLOSED[surface] | {"dissipation": 0.1, "friction": 0.3})
        for surface in CLOSED
    },
    "torsion_spring": (spatial.TorsionSpring, {"stiffness": 3, "damping": 2, "preload": 1, "turn": ((1, 2, 30), 2.5)}),
    "torque": (spatial.AppliedTorque, {"torque": ("1 + a.x", "2*sin(t)", "-wz(b)"), "frame": "b"}),
}
"""Forces between two bodies that nothing outside holds."""
CONSERVATIVE = {
    "spring_damper": (spatial.SpringDamper, {"stiffness": 30, "free_length": 0.5, "preload": 3, "spring_law": "5*s^3"}),
    "line_force": (spatial.LineForce, {"force": -4.0}),
    "bushing": (spatial.Bushing, NEAR | {"stiffness": SIX, "preload": (1, 2, 3, 0.4, 0.5, 0.6)}),
    "coupled_bushing": (spatial.Bushing, NEAR | {"stiffness": FULL}),
    **{
        f"bushing_free_about_{axis}": (
            spatial.Bushing,
            NEAR | {"stiffness": [[50, 60, 70], np.diag(np.roll([0, 30, 40], k)).tolist()], "turn": ((1, 2, 3), 0.7)},
        )
        for k, axis in enumerate("xyz")
    },
    "bushing_by_laws": (
        spatial.Bushing,
        NEAR | {"stiffness": SIX, "law_x": "1e3*s^3", "law_about_y": {"table": [[-3, -9], [0, 0], [3, 12]]}},
    ),
    "field": (spatial.FieldForce, {"stiffness": FULL, "free": (0.7, -0.4, 0.5, 0.1, 0.2, 0.3)}),
    **{f"{surface}_contact": (spatial.SphereContact, fields) for surface, fields in CLOSED.items()},
    "torsion_spring": (
        spatial.TorsionSpring,
        {"stiffness": 3, "free_angle": 1, "preload": 0.5, "turn": ((1, 2, 30), 2.5), "spring_law": "0.2*s^3"},
    ),
    "beam": (spatial.Beam, SECTION | {"apart": (0.8, 0.02, -0.03), "turn": ((1, 2, 3), 0.1)}),
}


LONG = {
    "force_in_axes_of_b", "coupled_bushing", "bushing_free_about_x", "bushing_free_about_y", "bushing_free_about_z", "bushing_by_laws",
    "field", "sphere_contact", "hollow_contact",
}  # fmt: skip
"""Variants of other cases, and what takes seconds to compile."""


def cases(names):
    return [pytest.param(name, marks=pytest.mark.long if name in LONG else ()) for name in names]


@pytest.mark.sampled(15)
@pytest.mark.long
@pytest.mark.parametrize("name", cases(INNER))
def test_action_is_reaction_in_force_and_in_torque(name):
    element, fields = INNER[name]
    for seed in range(10):
        found = wrenches(two_bodies(element, seed, **fields))
        assert np.max(np.abs(found)) > 0.1
        assert np.max(np.abs(found.sum(axis=0))) < 1e-13 * np.max(np.abs(found))


@pytest.mark.sampled(9)
@pytest.mark.long
@pytest.mark.parametrize("name", cases(CONSERVATIVE))
def test_energy_and_momenta_are_kept(name):
    element, fields = CONSERVATIVE[name]
    model = two_bodies(element, 3, **fields)
    solution = stiffmbs.run(model, duration=1, **FINE)
    assert np.ptp(solution["energy.kinetic"]) > 0.1
    assert solution.energy_drift() < 2e-7
    assert np.max(np.ptp(momenta(model, solution), axis=1)) < 1e-7


def test_a_mass_on_a_spring_of_no_length_moves_on_an_ellipse():
    """Every coordinate swings by itself (Hooke); the spring pulls at the centre, so that the body does not turn."""
    start, velocity, k, mass = np.array([0.3, -0.2, 0.1]), np.array([0.5, 1.0, -2.0]), 50.0, 2.0
    model = spatial.Model()
    model.add(
        "ball", spatial.Body(mass=mass, inertia=(0.1, 0.2, 0.25), position=tuple(start), velocity=tuple(velocity))
    )
    model.add("spring", spatial.SpringDamper(i="ball", j="ground", stiffness=k))
    solution = stiffmbs.run(model, duration=2, **FINE)
    w, t = np.sqrt(k / mass), solution.time
    expected = np.outer(start, np.cos(w * t)) + np.outer(velocity, np.sin(w * t)) / w
    found = np.array([solution[f"ball.{axis}"] for axis in "xyz"])
    np.testing.assert_allclose(found, expected, atol=1e-8)
    np.testing.assert_allclose([solution[f"spring.f{axis}"] for axis in "xyz"], -k * expected, atol=1e-6)


def alone(inertia=(0.1, 0.2, 0.25), **fields):
    model = spatial.Model()
    model.add("ball", spatial.Body(mass=2.0, inertia=inertia, **fields))
    return model


def test_a_force_in_ground_axes_throws_a_body_on_a_parabola_and_keeps_energy():
    model = alone(omega=(1, 2, 3))
    model.add("push", spatial.AppliedForce(i="ball", force=(1, -2, 3)))
    solution = stiffmbs.run(model, duration=2, **FINE)
    for axis, force in zip("xyz", (1, -2, 3), strict=True):
        np.testing.assert_allclose(solution[f"ball.{axis}"], force * solution.time**2 / 4, atol=1e-8)
        np.testing.assert_allclose(solution[f"push.f{axis}"], force, rtol=1e-12)
    assert solution.energy_drift() < 1e-8


@pytest.mark.parametrize("axes", [{"axes": "body"}, {"frame": {"body": "ball", "orientation": {"x": (0, 0, 1)}}}])
def test_a_force_in_body_axes_turns_with_the_body(axes):
    """A body spinning about x carries a force across: its velocity goes round a circle."""
    w, thrust = 3.0, 5.0
    model = alone(omega=(w, 0, 0))
    force = (0, 0, thrust) if "axes" in axes else (thrust, 0, 0)
    model.add("thrust", spatial.AppliedForce(i="ball", force=force, **axes))
    solution = stiffmbs.run(model, duration=2, **FINE)
    t = solution.time
    np.testing.assert_allclose(solution["ball.vy"], thrust / 2 / w * (np.cos(w * t) - 1), atol=1e-8)
    np.testing.assert_allclose(solution["ball.vz"], thrust / 2 / w * np.sin(w * t), atol=1e-8)


def test_a_torque_about_an_axis_of_the_body_spins_it_up():
    model = alone()
    model.add("motor", spatial.AppliedTorque(i="ball", torque=(0, 0, "2*t"), axes="body"))
    solution = stiffmbs.run(model, duration=2, **FINE)
    np.testing.assert_allclose(solution["ball.wz"], solution.time**2 / 0.25, atol=1e-8)
    np.testing.assert_allclose(solution["motor.tz"], 2 * solution.time, atol=1e-8)


@pytest.mark.long
def test_a_force_by_formula_is_the_spring_damper():
    law = {"stiffness": 20, "damping": 2, "free_length": 0.5}
    springs = {
        "spring": (spatial.SpringDamper, law),
        "along the line": (spatial.LineForce, {"force": "-20*(dm(a.i, b.j) - 0.5) - 2*vr(a.i, b.j)"}),
    }
    ends = []
    for element, fields in springs.values():
        model = two_bodies(element, 5, **fields)
        solution = stiffmbs.run(model, duration=1, **FINE)
        ends.append([solution[f"{name}"][-1] for name in ("a.x", "a.wy", "b.q2", "element.fx", "element.tz")])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-8)


def test_axes_and_a_frame_exclude_each_other():
    with pytest.raises(stiffmbs.InputError, match="found both 'frame' and 'axes: body', expected one of them"):
        spatial.AppliedForce(i="ball", force=(1, 2, 3), axes="body", frame="ground")


def test_a_torsion_spring_counts_the_turns_of_a_hinge():
    """Three turns each way: 20 rad."""
    k, moment, speed = 0.8, 0.2, 40.0
    across = {"z": (0, 1, 0)}
    model = spatial.Model()
    wheel = model.add("wheel", spatial.Body(mass=1, inertia=(0.1, moment, 0.15), omega=(0, speed, 0)))
    at = wheel.at(0, 0, 0, across)
    model.add("hinge", spatial.Revolute(i=at, j=spatial.Marker(body="ground", orientation=across)))
    model.add("spring", spatial.TorsionSpring(i=at, j=spatial.Marker(body="ground", orientation=across), stiffness=k))
    solution = stiffmbs.run(model, duration=7, **FINE)
    w = np.sqrt(k / moment)
    np.testing.assert_allclose(solution["spring.ty"], -k * speed / w * np.sin(w * solution.time), atol=1e-6)
    assert solution.energy_drift() < 1e-5  # of 160 J


def test_a_torsion_spring_needs_a_common_axis():
    model = alone()
    model.add("spring", spatial.TorsionSpring(i="ball", j={"body": "ground", "orientation": {"z": (1, 0, 0)}}))
    with pytest.raises(stiffmbs.InputError, match=r"spring: found the z axes of its markers drawn 90 degrees apart"):
        model.data()


def test_stiffness_may_be_written_in_four_ways():
    forms = [SIX, [SIX[:3], SIX[3:]], [np.diag(SIX[:3]).tolist(), np.diag(SIX[3:]).tolist()], np.diag(SIX).tolist()]
    matrices = [spatial.Bushing(i="a", j="b", stiffness=form).stiffness for form in forms]
    for matrix in matrices:
        np.testing.assert_array_equal([[part or 0.0 for part in row] for row in matrix], np.diag(SIX))


@pytest.mark.parametrize("axis", ["x", "y", "z"])
@pytest.mark.parametrize("degrees", [30.0, 170.0, 200.0])
def test_a_bushing_swings_about_one_axis_by_its_linear_law_past_half_a_turn(axis, degrees):
    """The moment is k times the angle, whatever the angle: harmonic, without a jump at half a turn."""
    k = "xyz".index(axis)
    stiffness, inertia = (3.0, 4.0, 5.0), (0.1, 0.2, 0.25)
    w = np.sqrt(stiffness[k] / inertia[k])
    omega = [0.0, 0.0, 0.0]
    omega[k] = np.radians(degrees) * w
    model = alone(inertia, omega=tuple(omega))
    model.add("bushing", spatial.Bushing(i="ball", j="ground", stiffness=(1, 1, 1, *stiffness)))
    solution = stiffmbs.run(model, duration=3, **FINE)
    swing = np.radians(degrees) * np.sin(w * solution.time)
    np.testing.assert_allclose(solution[f"bushing.t{axis}"], -stiffness[k] * swing, atol=1e-7)
    np.testing.assert_allclose(solution["energy.potential"], stiffness[k] * swing**2 / 2, atol=1e-7)


@pytest.mark.long
def test_a_wheel_in_a_bushing_without_stiffness_about_its_axis_spins_on():
    """Ten turns; the axle swings by the linear equations of a gyroscope, damped by its angular velocity across z."""
    spin, k, c = 30.0, 8.0, 0.4
    tilt = 0.001
    model = alone((0.1, 0.1, 0.2), orientation=turned((1, 0, 0), tilt), omega=(0, 0, spin))
    stiffness = [[1e4, 1e4, 1e4], [[k, 0, 0], [0, k, 0], [0, 0, 0]]]
    model.add("mount", spatial.Bushing(i="ball", j="ground", stiffness=stiffness, damping=[(0, 0, 0), (c, c, 0)]))
    solution = stiffmbs.run(model, duration=2.2, rtol=1e-10, atol=1e-13, points=201)
    assert 20 * np.pi < 30 * 2.2
    assert solution["ball.wz"] == pytest.approx(spin, rel=1e-4)
    # a = tilt about x + i tilt about y, angular velocity a' - i spin a, torque -k a - c (a' - i spin a)
    roots = np.roots([0.1, c - 0.2j * spin, k - 1j * spin * c])
    start = np.linalg.solve([[1, 1], roots], [tilt, 0])
    expected = start @ np.exp(np.outer(roots, solution.time))
    p = [solution[f"ball.q{n}"] for n in range(4)]
    axis = 2 * (p[1] * p[3] + p[0] * p[2]), 2 * (p[2] * p[3] - p[0] * p[1])
    np.testing.assert_allclose(-axis[1] + 1j * axis[0], expected, atol=1e-8)


def test_a_bushing_without_moments_holds_no_orientation_and_sets_no_limit():
    model = alone((0.1, 0.2, 0.25), omega=(5, 40, 1))
    model.add("mount", spatial.Bushing(i="ball", j="ground", stiffness=(1e3, 1e3, 1e3, 0, 0, 0), preload=(0,) * 6))
    solution = stiffmbs.run(model, duration=1, rtol=1e-8, points=11)
    assert solution.time[-1] == 1
    assert np.max(np.abs([solution[f"mount.t{axis}"] for axis in "xyz"])) == 0


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_bushing_that_is_wound_too_far_stops_the_run(solver):
    model = alone(omega=(0, 0, 30))
    model.add("mount", spatial.Bushing(i="ball", j="ground", stiffness=(1, 1, 1, 2, 2, 2)))
    solution = stiffmbs.run(model, duration=3, solver=solver, rtol=1e-8)
    assert "'mount': found its bodies rotated by three quarters of a revolution" in solution.message
    turned = 2 * np.arccos(solution["ball.q0"][-1])
    assert np.radians(260) < turned <= np.radians(270.001)


def test_the_quaternions_that_bodies_are_described_with_do_not_wind_a_bushing():
    """A body turned by 340 degrees is one turned by -20."""
    model = alone(orientation=tuple(-x for x in turned((0, 0, 1), np.radians(20))))
    model.add("mount", spatial.Bushing(i="ball", j="ground", stiffness=(1, 1, 1, 2, 2, 2)))
    solution = stiffmbs.run(model, duration=1e-3, points=2)
    assert solution["mount.tz"][0] == pytest.approx(-2 * np.radians(20), rel=1e-9)


@pytest.mark.long
def test_a_rotation_vector_is_that_of_the_logarithm():
    """The elastic moments of any rotation against a potential of SciPy's rotation vectors, by differences."""
    for seed in range(5):
        found, expected = _elastic_moments(seed, FULL)
        np.testing.assert_allclose(found, expected, atol=1e-6)


def _elastic_moments(seed, stiffness):
    """The elastic force and torque of a bushing on its first body, and minus the gradient of its potential."""
    from scipy.spatial.transform import Rotation

    turn = np.random.default_rng(seed).normal(size=3)
    model = two_bodies(spatial.Bushing, seed, turn=(turn, np.linalg.norm(turn)), stiffness=stiffness)
    data = model.data()
    i, j = (data.initial_marker(element) for element in (data.forces["element"].i, data.forces["element"].j))

    def potential(move):
        axes = Rotation.from_rotvec(move[3:]).as_matrix() @ i.axes
        s = [*(j.axes.T @ (i.point + move[:3] - j.point)), *Rotation.from_matrix(j.axes.T @ axes).as_rotvec()]
        return s @ np.array(stiffness) @ s / 2

    h = 1e-5
    force, torque = wrenches(model)[0]
    gradient = [(potential(h * e) - potential(-h * e)) / (2 * h) for e in np.eye(6)]
    return [*force, *(torque - np.cross(i.point, force))], -np.array(gradient)


@pytest.mark.sampled(15)
@pytest.mark.long
@pytest.mark.parametrize("angle", [0.0, 1e-3, 0.4, 1.0, 2.5, 3.6])
@pytest.mark.parametrize("free", [None, *(pytest.param(k, marks=pytest.mark.long) for k in range(3))])
def test_derivatives_of_a_coupled_bushing_at_small_and_large_rotations(angle, free):
    """On both sides of where the series of the rotation vector gives way to its closed form; whole, and free about an axis."""
    kept = [k for k in range(6) if free is None or k != 3 + free]
    stiffness = [[FULL[row][k] if {row, k} <= set(kept) else 0.0 for k in range(6)] for row in range(6)]
    model = two_bodies(spatial.Bushing, 6, turn=((2, -1, 1), angle), stiffness=stiffness, damping=stiffness)
    state = State(stiffmbs.compile_model(model.data()))
    assert_close(term(state, "tangent", "f_q"), derivative(lambda: term(state, "motion", "f"), state.q))
    assert_close(term(state, "tangent", "f_u"), derivative(lambda: term(state, "motion", "f"), state.u))


@pytest.mark.long
@pytest.mark.parametrize("stiffness", [1e4, 1e6, 1e9])
def test_a_stiff_bushing_holds_as_a_spherical_joint_does(stiffness):
    """The deflection is the force over the stiffness: a pendulum's motion differs by about that, and its force too."""

    def pendulum(name, element):
        model = spatial.Model(gravity=(0, 0, -9.81))
        bar = {
            "mass": 1,
            "inertia": (0.01, 0.03, 0.03),
            "position": (0.3, 0, 0),
            "omega": (2, 0, 1),
            "velocity": (0, 0.3, 0),
        }
        model.add("bar", spatial.Body(**bar))
        model.add("hold", element)
        return stiffmbs.run(model, duration=1, rtol=1e-8, points=51)

    at = {"i": spatial.Marker(body="bar", point=(-0.3, 0, 0)), "j": "ground"}
    damping = 2 * np.sqrt(stiffness)
    soft = pendulum(
        "soft", spatial.Bushing(**at, stiffness=(stiffness,) * 3 + (0,) * 3, damping=(damping,) * 3 + (0,) * 3)
    )
    rigid = pendulum("rigid", spatial.Spherical(**at))
    for channel in ("bar.x", "bar.y", "bar.z", "bar.q2"):
        assert np.max(np.abs(soft[channel] - rigid[channel])) < 60 / stiffness + 1e-5, channel
    late = soft.time > 0.3
    assert np.max(np.abs(soft["hold.fz"] - rigid["hold.fz"])[late]) < 3e3 / stiffness + 1e-2


@pytest.mark.long
def test_coupled_components_swing_in_their_eigenmodes():
    """Small motions of a body in a field of 6x6 stiffness about the place without force: each mode by itself."""
    from scipy.linalg import eigh

    inertia, free = (0.1, 0.2, 0.25), (0.5, 0.1, -0.2)
    squares, shapes = eigh(FULL, np.diag([2.0, 2, 2, *inertia]))
    size = 1e-5
    for mode in (0, 3, 5):
        start = size * shapes[:, mode]
        place = tuple(np.array(free) + start[:3])
        model = alone(inertia, position=place, orientation=turned(start[3:], np.linalg.norm(start[3:])))
        model.add("field", spatial.FieldForce(i="ball", j="ground", stiffness=FULL, free=(*free, 0, 0, 0)))
        solution = stiffmbs.run(model, duration=1, rtol=1e-9, atol=1e-14, points=51)
        swing = np.cos(np.sqrt(squares[mode]) * solution.time)
        found = [*(solution[f"ball.{axis}"] for axis in "xyz"), *(2 * solution[f"ball.q{k}"] for k in (1, 2, 3))]
        expected = np.outer([*free, 0, 0, 0], np.ones_like(swing)) + np.outer(start, swing)
        np.testing.assert_allclose(found, expected, atol=30 * size**2)


def cantilever(**load):
    """The tip of a beam whose root is in ground, at rest in a hold of drag, under a load in its own direction."""
    model = spatial.Model()
    model.add("tip", spatial.Body(mass=1.0, inertia=(0.1, 0.1, 0.1), position=(0.8, 0, 0)))
    section = SECTION | {"young": 2e9, "shear_modulus": 8e8}
    model.add("beam", spatial.Beam(i="tip", j="ground", **section, damping_ratio=2e-4))
    for name, (element, fields) in load.items():
        model.add(name, element(i="tip", **fields))
    solution = stiffmbs.run(model, duration=0.2, rtol=1e-9, points=3)
    place = [*(solution[f"tip.{axis}"][-1] for axis in "xyz"), *(2 * solution[f"tip.q{k}"][-1] for k in (1, 2, 3))]
    return np.array(place) - [0.8, 0, 0, 0, 0, 0], section


@pytest.mark.long
def test_a_cantilever_deflects_as_timoshenko_says():
    """F L^3/(3 E I) and, by shear, asy F L/(G A); slope F L^2/(2 E I), without shear."""
    F = 10.0
    s, b = cantilever(load=(spatial.AppliedForce, {"force": (0, F, 0)}))
    EI, L = b["young"] * b["izz"], b["length"]
    shear = b["asy"] * F * L / (b["shear_modulus"] * b["area"])
    np.testing.assert_allclose(s[1], F * L**3 / (3 * EI) + shear, rtol=1e-5)
    np.testing.assert_allclose(s[5], F * L**2 / (2 * EI), rtol=1e-5)
    s, _ = cantilever(load=(spatial.AppliedForce, {"force": (0, 0, F)}))
    EI = b["young"] * b["iyy"]
    shear = b["asz"] * F * L / (b["shear_modulus"] * b["area"])
    np.testing.assert_allclose(s[2], F * L**3 / (3 * EI) + shear, rtol=1e-5)
    np.testing.assert_allclose(s[4], -F * L**2 / (2 * EI), rtol=1e-5)


def test_a_cantilever_is_twisted_stretched_and_bent_by_its_stiffness():
    T = 10.0
    s, b = cantilever(
        load=(spatial.AppliedTorque, {"torque": (T, 0, T)}), pull=(spatial.AppliedForce, {"force": (T, 0, 0)})
    )
    L = b["length"]
    EI = b["young"] * b["izz"]
    np.testing.assert_allclose(s[0], T * L / (b["young"] * b["area"]), rtol=1e-4, atol=1e-11)
    np.testing.assert_allclose(s[3], T * L / (b["shear_modulus"] * b["torsion"]), rtol=1e-4)
    np.testing.assert_allclose(s[5], T * L / EI, rtol=1e-4)
    np.testing.assert_allclose(s[1], T * L**2 / (2 * EI), rtol=1e-4)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"stiffness": (1, 2, 3)}, "stiffness: found a list of 3, expected six numbers, two blocks (of three numbers or 3x3), or six rows of six"),
        ({"stiffness": [[[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[1, 0, 0], [0, 1, 0], [0, 2, 1]]]}, "found 0 in row 5, column 6"),
        ({"damping": ("1 N/m", 0, 0, 0, 0, 0)}, "damping.0.0: found '1 N/m', which is in N/m, expected a damping in N s/m"),
        ({"stiffness": [[1, 2, 3], 4]}, "stiffness: found a list of 2, expected six numbers, two blocks"),
        ({"stiffness": [[1, 2, 3], [[1, 2], [3, 4], [5, 6]]]}, "stiffness: found a list of 2, expected six numbers, two"),
        ({"stiffness": "stiff"}, "stiffness: found 'stiff', expected six numbers"),
        ({"law_about_x": "s + v"}, "law_about_x: found the unknown name 'v'"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_bushing_is_said(fields, message):
    with pytest.raises(stiffmbs.InputError) as error:
        spatial.Bushing(i="a", j="b", **fields)
    assert message in str(error.value)


def test_what_is_wrong_with_a_beam_is_said():
    with pytest.raises(stiffmbs.InputError, match="found both 'damping' and 'damping_ratio', expected one of them"):
        spatial.Beam(i="a", j="b", **SECTION, damping_ratio=0.1, damping=SIX)
    with pytest.raises(stiffmbs.InputError, match=r"area: found 0, expected an area greater than 0 m\^2"):
        spatial.Beam(i="a", j="b", **SECTION | {"area": 0})
