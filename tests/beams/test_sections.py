"""Sections of beams with several nodes: derivatives against differences, energy, and directions of parameters."""

import numpy as np
import pytest

from stiffmbs import Body, InputError, Model, compile_model, spatial
from stiffmbs.compile.directional.direction import Direction, Numbers
from stiffmbs.compile.state import State
from stiffmbs.compile.terms import TERM_SETS
from stiffmbs.elements.forces.exact_beam import BeamSection

from ..elements.test_element_derivatives import assert_close, derivative, rates, term

FORMS = [(d, n, damping) for d in (2, 3) for n in (3, 4, 5) for damping in (None, 0.3)]


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


@pytest.mark.parametrize(("dimensions", "n", "damping"), FORMS)
def test_forces_follow_from_the_energy_and_derivatives_from_the_forces(dimensions, n, damping):
    state = state_with(dimensions, n, damping)
    for name, vector in (("f_q", state.q), ("f_u", state.u)):
        assert_close(np.array(term(state, "tangent", name)), derivative(lambda: term(state, "motion", "f"), vector))
    stored = derivative(lambda: output(state, "potential").copy(), state.q) @ rates(state)
    lost = output(state, "power")[0] if damping else 0.0
    assert lost <= 0
    assert term(state, "motion", "f") @ state.u == pytest.approx(lost - stored[0], rel=1e-8)


@pytest.mark.parametrize(("dimensions", "n", "damping"), [FORMS[1], FORMS[-1]])
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
