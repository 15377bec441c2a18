"""Spectral beams: derivatives of their sections against differences, closed forms, and converged values of motions."""

import math

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, InputError, Model, compile_model, read_scene, spatial
from stiffmbs.compile.directional.direction import Direction, Numbers
from stiffmbs.compile.state import State
from stiffmbs.compile.terms import TERM_SETS
from stiffmbs.elements.forces.exact_beam import BeamSection
from stiffmbs.model.beams.interpolation import Group, divided

from ..elements.test_element_derivatives import assert_close, derivative, rates, term
from .scenes import at_rest, cantilever, flying_in_space, pendulum, princeton, right_angle

FORMS = [
    pytest.param(d, n, damping, marks=[] if (d + n, damping) in ((6, 0.3), (8, 0.3)) else pytest.mark.long)
    for d in (2, 3)
    for n in (3, 4, 5)
    for damping in (None, 0.3)
]


def state_with(dimensions, n, damping):
    """Bodies in random motion with a section whose markers, polynomials and stiffness are random."""
    rng = np.random.default_rng(n)
    model, nodes, d = (Model() if dimensions == 2 else spatial.Model()), [], 3 * (dimensions - 1)
    for k in range(n):
        point, turn = rng.normal(size=dimensions), np.array([1, *(0.3 * rng.normal(size=3))])
        turn /= np.linalg.norm(turn)
        if dimensions == 2:
            model.add(f"b{k}", Body(mass=1, inertia=1, position=(k, 0.2), angle=0.5 * rng.normal()))
            nodes.append({"body": f"b{k}", "point": point, "angle": 0.3 * rng.normal()})
        else:
            model.add(f"b{k}", spatial.Body(mass=1, inertia=(1, 2, 2.5), position=(k, 0, 0.2), orientation=tuple(turn)))
            nodes.append({"body": f"b{k}", "point": point, "orientation": tuple(turn)})
    K = rng.normal(size=(d, d))
    model.add(
        "s",
        (BeamSection if dimensions == 2 else spatial.BeamSection)(
            nodes=nodes, reference=n // 2, shapes=rng.normal(size=n), slopes=rng.normal(size=n), length=0.7,
            unloaded=(1, *(0.2 * rng.normal(size=d - 1))), stiffness=(K @ K.T + (K @ K.T).T) / 2, damping_ratio=damping,
        ),
    )  # fmt: skip
    state = State(compile_model(model.data()))
    state.q[:] += 0.05 * rng.normal(size=len(state.q))
    state.u[:] = rng.normal(size=len(state.u))
    return state


def output(state, name):
    state.evaluate("output", 0.0)
    (g,) = (k for k, group in enumerate(state.system.groups) if group.names == ("s",))
    first = int(state.system.places["output"][g, 1 + TERM_SETS["output"].index(name)])
    return state.values["output"][first : first + 1]


@pytest.mark.long
@pytest.mark.sampled(12)
@pytest.mark.parametrize(("dimensions", "n", "damping"), FORMS)
def test_forces_follow_from_the_energy_and_derivatives_from_the_forces(dimensions, n, damping):
    state = state_with(dimensions, n, damping)
    for name, vector in (("f_q", state.q), ("f_u", state.u)):
        assert_close(np.array(term(state, "tangent", name)), derivative(lambda: term(state, "motion", "f"), vector))
    stored = derivative(lambda: output(state, "potential").copy(), state.q) @ rates(state)
    lost = output(state, "power")[0] if damping else 0.0
    assert lost <= 0
    assert term(state, "motion", "f") @ state.u == pytest.approx(lost - stored[0], rel=1e-8)


@pytest.mark.long
@pytest.mark.parametrize(("dimensions", "n", "damping"), [(2, 3, 0.3), (3, 5, 0.3)])
def test_directional_derivatives_by_numbers_and_state(dimensions, n, damping):
    state = state_with(dimensions, n, damping)
    rng = np.random.default_rng(3)
    group = next(group for group in state.system.groups if group.names == ("s",))
    changed = tuple(each.numbers * 0 for each in state.system.groups)
    g = state.system.groups.index(group)
    changed[g][:] = rng.normal(size=len(changed[g])) * group.numbers
    reference = n * (5 if dimensions == 2 else 16)
    changed[g][reference] = 0
    direction = Direction(state, "acceleration", Numbers(changed, frozenset([g]), np.zeros(state.system.n_u)))
    moved = rng.normal(size=len(state.q)), rng.normal(size=len(state.u))
    direction.q[:], direction.u[:] = moved
    direction.evaluate(0.0)
    found, (q, u, numbers) = direction.vector("f"), (state.q.copy(), state.u.copy(), group.numbers.copy())

    def forces(h):
        state.q[:], state.u[:], group.numbers[:] = q + h * moved[0], u + h * moved[1], numbers + h * changed[g]
        return term(state, "acceleration", "f").copy()

    h = 1e-5
    expected = (8 * (forces(h) - forces(-h)) - (forces(2 * h) - forces(-2 * h))) / (12 * h)
    assert found == pytest.approx(expected, rel=1e-7, abs=1e-7 * np.max(np.abs(expected)))


def test_lengths_of_the_polynomials_are_checked():
    fields = {"nodes": ("a", "b", "c"), "reference": 1, "slopes": (1, 2, 3), "length": 1, "stiffness": np.eye(3)}
    with pytest.raises(InputError, match="shapes: found 2 numbers, expected 3, one for each node"):
        BeamSection(shapes=(1, 2), **fields)
    with pytest.raises(InputError, match="expected the place of a node from 0 to 2"):
        BeamSection(shapes=(1, 2, 3), **{**fields, "reference": 3})


def spectral(text):
    return text.replace("elements:", "interpolation: spectral, elements:")


def test_groups_integrate_mass_and_polynomials_exactly():
    for p in (2, 3, 4):
        group = Group.of(p)
        places = group.nodes - 0.5
        assert np.all(group.weights > 0) and group.weights.sum() == pytest.approx(1)
        assert group.weights @ places == pytest.approx(0, abs=1e-12)
        assert group.weights @ places**2 == pytest.approx(1 / 12)
        for place, _, values, slopes in group.sections:
            assert values @ group.nodes**p == pytest.approx(place**p)
            assert slopes @ group.nodes**p == pytest.approx(p * place ** (p - 1))


def test_elements_form_groups_of_three_and_four():
    for n in range(1, 40):
        sizes = divided(n, 4)
        assert sum(sizes) == n and max(sizes) <= 4
        assert min(sizes) > 2 or n in (1, 2, 5)


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("n", [3, 4, 7])
def test_an_end_moment_rolls_a_beam_up_to_a_circle(n):
    found = at_rest(spectral(cantilever(n, torque=math.tau)))
    assert [found["strip.end.x"], found["strip.end.y"]] == pytest.approx([0, 0], abs=1e-9)
    assert found["strip.element1.m3"] == pytest.approx(math.tau, rel=1e-9)


@pytest.mark.parametrize("n", [3, 4])
def test_the_end_of_a_linear_cantilever_has_no_error(n):
    found = at_rest(spectral(cantilever(n, force="[0, 1e-5]", stiffness="[1e4, 50, 1]")))
    assert found["strip.end.y"] == pytest.approx(1e-5 * (1 / 3 + 1 / 50), rel=1e-7)


def test_a_tapered_cantilever_has_no_error():
    """A cone of diameters D and d: the deflection under an end load is 64 P L^3/(3 pi E D^3 d)."""
    found = at_rest("""
bodies:
  cone:
    type: beam
    start: [0, 0]
    end: [1, 0]
    elements: 6
    interpolation: spectral
    section: {type: circle, diameter: 40 mm}
    section_end: {type: circle, diameter: 20 mm}
    material: {E: 200 GPa, nu: 0, density: 7800}
joints: {clamp: {type: fixed, i: cone.start, j: ground}}
forces: {P: {type: force, i: cone.end, force: [0, 1]}}
""")
    bending = 64 / (3 * math.pi * 200e9 * 0.04**3 * 0.02)
    shear = 1 / (6 / 7 * 100e9 * math.pi / 4 * 0.04 * 0.02)
    assert found["cone.end.y"] == pytest.approx(bending + shear, rel=1e-6)


def test_section_forces_follow_from_statics_and_there_are_no_others():
    """Shear is P and the moment P (L - x); the moment is exact at the Gauss points of each group."""
    scene = read_scene(spectral(cantilever(8, force="[2e-3, 1e-3]")))
    found = stiffmbs.equilibrium(scene).channels
    places = np.concatenate(
        [k / 2 + Group.of(4).nodes[0] + [place / 2 for place, *_ in Group.of(4).sections] for k in (0, 1)]
    )
    for k, x in enumerate(places, 1):
        forces = [found[f"strip.element{k}.{name}"] for name in ("n1", "n2", "m3")]
        assert forces == pytest.approx([2e-3, 1e-3, 1e-3 * (1 - x)], abs=2e-6)
    assert "strip.element1.fx" not in found
    with pytest.raises(InputError, match=r"strip\.element1\.fx"):
        read_scene(spectral(cantilever(8)) + "requests: {q: strip.element1.fx}")


def test_the_princeton_beam():
    found = at_rest(spectral(princeton(8, 13.345, 45)))
    tip = [found["strip.end.y"], found["strip.end.z"], found["strip.end.x"] - 0.508]
    assert tip == pytest.approx([0.156587823, 0.015342258, -0.030361114], abs=1e-7)


@pytest.mark.long
def test_a_rubber_pendulum():
    found = stiffmbs.run(stiffmbs.read_scene(spectral(pendulum(8))), solver="radau")
    end = [found["rod.end.x"][-1], found["rod.end.y"][-1]]
    assert end == pytest.approx([0.4365307, -0.8979809], abs=1e-3)
    assert np.ptp(found["energy.total"]) < 1e-5 * np.max(found["energy.kinetic"])


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "channels", "expected", "tolerance"),
    [
        (flying_in_space(8), ("rod.start.x", "rod.start.y", "rod.start.z"), (19.213600, 1.625556, -2.127248), 2e-3),
        (right_angle(4), ("frame.elbow.z", "frame.end.z"), (4.642067, 3.508934), 4e-3),
    ],
)  # fmt: skip
def test_thick_beams_converge_fast(text, channels, expected, tolerance):
    """Beams with a rotary inertia of a hundred times that of a real section, and waves along them."""
    found = stiffmbs.run(stiffmbs.read_scene(spectral(text)), solver="radau")
    assert [found[name][-1] for name in channels] == pytest.approx(expected, abs=tolerance)


@pytest.mark.long
def test_sensitivities_against_differences():
    text = spectral("""
parameters: {E: 5 MPa, L: 1 m, d: 20 mm, rho: 1100}
gravity: [0, -2]
bodies:
  s: {type: beam, start: [0, 0], end: [L, 0], elements: 4, section: {type: circle, diameter: d},
      material: {E: E, density: rho}, damping: 10 ms}
joints: {c: {type: fixed, i: s.start, j: ground}}
run: {duration: 0.2, rtol: 1e-9}
""")
    values = {"E": 5e6, "L": 1.0, "d": 0.02, "rho": 1100.0}
    found = stiffmbs.sensitivities(stiffmbs.read_scene(text), to=list(values), of="final(s.end.y)")
    for name, value in values.items():
        ends = [
            stiffmbs.run(stiffmbs.read_scene(text, [(name, value * factor)]), rtol=1e-10)["s.end.y"][-1]
            for factor in (1 - 1e-4, 1 + 1e-4)
        ]
        assert found.to[name] == pytest.approx((ends[1] - ends[0]) / (2e-4 * value), rel=1e-3)
