"""Every derivative that SymPy and the kernels give, against high-order differences: any element, found by existing."""

import numpy as np
import pytest

from stiffmbs import RunSettings, compile_model
from stiffmbs.compile.equations import Equations
from stiffmbs.compile.state import State
from stiffmbs.compile.terms import TERM_AXES
from stiffmbs.elements.element import Joint
from stiffmbs.solve.formulations import FORMULATIONS

from ..by_callbacks import Callbacks
from ..random_parts import CASES, add_joints, random_element, refers_to_joints, three_bodies, three_bodies_in_space

T = 0.37
STEP = 3e-3
MANY = (pytest.mark.long, pytest.mark.sampled(11))
"""A number without a common factor with that of the formulations, so that all of them have their turn."""
WEIGHTS = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}  # eighth order, centred
TOLERANCE = 1e-8


def derivative(function, vector):
    """The Jacobian of a function of a vector, column by column, changing the vector in place."""
    columns = []
    for k in range(len(vector)):
        kept, column = vector[k], 0.0
        for offset, weight in WEIGHTS.items():
            for sign in (1, -1):
                vector[k] = kept + sign * offset * STEP
                column = column + sign * weight * function() / STEP
        vector[k] = kept
        columns.append(column)
    return np.stack(columns, axis=-1) if columns else np.zeros((len(function()), 0))


def time_derivative(function):
    return sum(
        sign * weight * function(T + sign * offset * STEP) / STEP
        for offset, weight in WEIGHTS.items()
        for sign in (1, -1)
    )


def assert_close(found, expected):
    assert np.max(np.abs(found - expected), initial=0) <= TOLERANCE * max(1, np.max(np.abs(expected), initial=0))


def case_name(case):
    dimensions, kind, (left_out, given) = case
    words = [str(value) for _, value in given if isinstance(value, str)]
    return "-".join(
        [*(["space"] if dimensions == 3 else []), kind.kind, *(f"no_{name}" for name in sorted(left_out)), *words]
    )


def takes_long(case):
    """All in space, and of the plane the cam, whose equations are the longest."""
    return case[0] == 3 or case_name(case) == "point_on_curve-no_y"


@pytest.fixture(
    params=[pytest.param(case, marks=MANY if takes_long(case) else (), id=case_name(case)) for case in CASES]
)
def state(request):
    return state_with(*request.param)


def state_with(dimensions, kind, form, with_model=False):
    """A random state of three bodies with a random element of a class."""
    rng = np.random.default_rng(7)
    model = three_bodies(rng) if dimensions == 2 else three_bodies_in_space(rng)
    element = random_element(kind, rng, form, dimensions)
    if refers_to_joints(element):
        add_joints(model)
    model.add("element", element)
    state = State(compile_model(model.data()))
    state.lam[:] = rng.uniform(-1, 1, len(state.lam))
    state.mu[:] = rng.uniform(-1, 1, len(state.mu))
    state.is_joint = issubclass(kind, Joint)
    return (state, model.data()) if with_model else state


def rates(state):
    """The rates of the coordinates; counters of turns rest, on which nothing depends."""
    return state.system.of_body.position_rates(state.q, state.u)


def rates_of_each_velocity(state):
    """Z of q' = Z u: in space quaternions have rates of their own."""
    return np.stack([state.system.of_body.position_rates(state.q, one) for one in np.eye(len(state.u))], axis=-1)


def term(state, term_set, name, t=T):
    state.evaluate(term_set, t)
    two = len(TERM_AXES[name]) == 2
    return (state.matrix if two else state.vector)(term_set, name)


def test_constraints_and_their_jacobian(state):
    assert_close(term(state, "motion", "C_q"), derivative(lambda: term(state, "motion", "C"), state.q))
    assert_close(term(state, "position", "C_q"), term(state, "motion", "C_q"))
    assert_close(term(state, "position", "C"), term(state, "motion", "C"))


def test_velocity_level_is_the_rate_of_the_position_level(state):
    partial = time_derivative(lambda t: term(state, "motion", "C", t))
    holonomic = state.system.holonomic
    assert_close(
        term(state, "motion", "V")[holonomic], (term(state, "motion", "C_q") @ rates(state) + partial)[holonomic]
    )
    Z = rates_of_each_velocity(state)
    assert_close(term(state, "motion", "J")[holonomic], (term(state, "motion", "C_q") @ Z)[holonomic])
    assert_close(term(state, "motion", "J"), derivative(lambda: term(state, "motion", "V"), state.u))
    assert_close(term(state, "tangent", "V_q"), derivative(lambda: term(state, "motion", "V"), state.q))


def test_gamma_is_minus_the_rate_of_the_velocity_level_without_accelerations(state):
    along = derivative(lambda: term(state, "motion", "V"), state.q) @ rates(state)
    partial = time_derivative(lambda t: term(state, "motion", "V", t))
    assert_close(term(state, "acceleration", "gamma"), -(along + partial))


@pytest.mark.parametrize("name", ["lam", "mu"])
def test_change_of_constraint_forces_with_position(state, name):
    n_c = state.system.n_c
    weights = getattr(state, name)[:n_c]
    block = {"lam": "J", "mu": "C_q"}[name]
    expected = derivative(lambda: term(state, "motion", block).T @ weights, state.q)
    assert_close(term(state, "tangent", f"G_{name}"), expected)


def test_applied_forces_and_their_derivatives(state):
    assert_close(term(state, "tangent", "f_q"), derivative(lambda: term(state, "motion", "f"), state.q))
    assert_close(term(state, "tangent", "f_u"), derivative(lambda: term(state, "motion", "f"), state.u))
    assert_close(term(state, "tangent", "f_lam"), derivative(lambda: term(state, "motion", "f"), state.lam))
    assert_close(term(state, "acceleration", "f"), term(state, "motion", "f"))


def test_a_potential_gives_the_force_at_rest(state):
    if state.is_joint:
        return
    state.u[:] = 0
    state.evaluate("output", T)
    system = state.system
    source = system.term("output", "potential").source

    def potential():
        state.evaluate("output", T)
        return np.array([state.values["output"][source].sum()])

    if len(source) == len(system.bodies):
        pytest.skip("this force has no potential")
    assert_close(term(state, "motion", "f"), -derivative(potential, state.q)[0] @ rates_of_each_velocity(state))


def test_power_is_what_a_force_brings_into_the_energy(state):
    """Kinetic and potential energy together change by the work of the forces, and as the potentials do."""
    if state.is_joint:
        return
    state.evaluate("output", T)
    potential, power = (state.system.term("output", name).source for name in ("potential", "power"))
    brought = state.values["output"][power].sum()

    def stored():
        state.evaluate("output", T)
        return np.array([state.values["output"][potential].sum()])

    changing = derivative(stored, state.q)[0] @ rates(state)
    assert_close(term(state, "motion", "f") @ state.u + changing, brought)


def test_counters_have_the_rates_of_their_angles(state):
    if not state.system.n_counters:
        return
    turning = derivative(lambda: term(state, "position", "continuous_angle"), state.q) @ rates(state)
    assert_close(term(state, "acceleration", "angle_rate"), turning)
    assert np.any(turning)


@pytest.mark.parametrize(
    "formulation",
    [
        pytest.param(formulation, marks=MANY if name == "index1" else (), id=name)  # by kernels of its own
        for name, formulation in FORMULATIONS.items()
    ],
)
def test_iteration_matrix_of_every_formulation(state, formulation):
    """dr/dy + cj dr/dy' of the whole residual, slot by slot."""
    rng = np.random.default_rng(3)
    equations = Equations(formulation(RunSettings(stabilisation=2.0)), state.system)
    state.relax(rng.uniform(0.1, 1, state.system.n_c), rng.uniform(0.1, 1, state.system.n_c))
    y, yp = rng.uniform(-1, 1, equations.n), rng.uniform(-1, 1, equations.n)
    y[equations.at["q"]] = state.q + rng.uniform(-0.1, 0.1, len(state.q))
    callbacks = Callbacks(equations, state)
    cj = 3.7

    def residual():
        r = np.empty(equations.n)
        callbacks.residual(T, y, yp, r)
        return r

    expected = derivative(residual, y) + cj * derivative(residual, yp)
    matrix = np.zeros((equations.n, equations.n))
    callbacks.jacobian(T, y, yp, None, cj, matrix)
    assert_close(matrix, expected)
