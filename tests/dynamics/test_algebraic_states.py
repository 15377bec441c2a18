"""Algebraic states: by every solver and formulation against minimal coordinates, in equilibrium, about a state, and where they end."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import stiffmbs
from stiffmbs import AlgebraicState, AppliedForce, AppliedTorque, Body, Drive, Marker, Model, Prismatic, Revolute, State

SOLVERS: list[dict[str, object]] = [
    *({"solver": "bdf", "formulation": name} for name in ("SI2", "I3", "SI1", "index1")),
    {"solver": "projected"},
    {"solver": "projected", "scheme": "dopri5"},
    {"solver": "projected", "scheme": "rk4", "step": 2e-3},
    {"solver": "auto"},
]


def pushed(zero: str, force: str, start: float = 0.0) -> Model:
    """A cart of 2 kg at 0.3 m on a rail, with an algebraic state p and a force."""
    model = Model("pushed")
    model.add("cart", Body(mass=2, inertia=1, position=(0.3, 0)))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("p", AlgebraicState(zero=zero, start=start))
    model.add("push", AppliedForce(i="cart", force=(force, 0)))
    return model


def valve(x: float, v: float) -> float:
    """The p with p^3 + p = 5 x + v."""
    return float(brentq(lambda p: p**3 + p - 5 * x - v, -50, 50, xtol=1e-15))


def with_valve() -> Model:
    """A cart pushed by p and a state that follows p."""
    model = pushed("p^3 + p - 5*cart.x - cart.vx", "-20*p")
    model.add("w", State(rate="p - w"))
    return model


@pytest.mark.sampled(3)
@pytest.mark.parametrize("settings", SOLVERS, ids=lambda s: "-".join(str(value) for value in s.values()))
def test_every_solver_finds_the_motion_of_minimal_coordinates(settings: dict[str, object]) -> None:
    solution = with_valve().run(
        duration=2.0, points=21, **{"rtol": 1e-8, **settings} if "step" not in settings else settings
    )
    exact = solve_ivp(
        lambda t, y: [y[1], -10 * valve(y[0], y[1]), valve(y[0], y[1]) - y[2]],
        (0, 2), [0.3, 0, 0], t_eval=solution.time, rtol=1e-11, atol=1e-12, method="DOP853",
    )  # fmt: skip
    assert abs(solution["cart.x"] - exact.y[0]).max() < 1e-7
    assert abs(solution["w"] - exact.y[2]).max() < 1e-7
    assert abs(solution["p"] - [valve(*state) for state in exact.y[:2].T]).max() < 1e-6
    assert "p.rate" not in solution.channels


@pytest.mark.parametrize("settings", [SOLVERS[0], SOLVERS[4]], ids=["bdf", "dop853"])
def test_a_state_that_follows_a_reaction_is_the_reaction_itself(settings: dict[str, object]) -> None:
    def hanging(torque: str) -> Model:
        model = Model("rubbing", gravity=(0, -9.81))
        model.add("bar", Body(mass=1.2, inertia=0.036, position=(0.3, 0)))
        model.add("hinge", Revolute(i=Marker(body="bar", point=(-0.3, 0)), j="ground"))
        if "pressed" in torque:
            model.add("pressed", AlgebraicState(zero="pressed - sqrt(fx(hinge)^2 + fy(hinge)^2 + 1)", start="10 N"))
        model.add("friction", AppliedTorque(i="bar", torque=torque))
        return model

    one = hanging("-0.02*pressed*tanh(bar.omega/0.05)").run(duration=1.0, points=11, rtol=1e-8, **settings)
    law = "-0.02*sqrt(fx(hinge)^2 + fy(hinge)^2 + 1)*tanh(bar.omega/0.05)"
    other = hanging(law).run(duration=1.0, points=11, rtol=1e-9, solver="projected")
    assert abs(one["bar.angle"] - other["bar.angle"]).max() < 1e-6


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_an_event_of_an_algebraic_state_is_located(solver: str) -> None:
    solution = pushed("p - 5*cart.x", "-20*max(p, 0.5)").run(duration=0.9, rtol=1e-9, solver=solver)
    w = np.sqrt(50)  # x'' = -w^2 x down to x = 0.1, then x'' = -5
    met = np.arccos(1 / 3) / w
    end = 0.1 - 0.3 * w * np.sin(w * met) * (0.9 - met) - 2.5 * (0.9 - met) ** 2
    assert solution["cart.x"][-1] == pytest.approx(end, abs=2e-8)


def test_modes_and_response_have_the_state_put_out() -> None:
    model = with_valve()
    p = valve(0.3, 0.0)
    slope = 3 * p * p + 1
    values = [value for mode in stiffmbs.modes(model).modes for value in mode.eigenvalues]
    expected = [-1, *np.roots([1, 10 / slope, 50 / slope])]
    assert np.sort_complex(np.array(values)) == pytest.approx(np.sort_complex(np.array(expected)), rel=1e-9)
    response = stiffmbs.transfer(model, ["cart.fx"], ["p"]).state_space()
    s = 2j
    found = response.C @ np.linalg.solve(s * np.eye(3) - response.A, response.B) + response.D
    assert found[0, 0] == pytest.approx((5 + s) / slope * 0.5 / (s * s + (10 * s + 50) / slope), rel=1e-6)


@pytest.mark.long
def test_an_equilibrium_solves_for_it() -> None:
    found = stiffmbs.equilibrium(pushed("p^3 + p - 5*cart.x", "4 - p"))
    assert found.channels["p"] == pytest.approx(4, rel=1e-9)
    assert found.channels["cart.x"] == pytest.approx(68 / 5, rel=1e-9)


def test_kinematic_analysis_solves_for_it_along_the_motion() -> None:
    model = Model("driven")
    model.add("cart", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("motor", Drive(joint="rail", position="0.2*sin(3*t)"))
    model.add("p", AlgebraicState(zero="p^3 + p - cart.x"))
    model.add("w", State(rate="p - w"))
    solution = model.run(duration=1.0, points=11, solver="kinematic")
    p = [brentq(lambda p, x=x: p**3 + p - x, -1, 1, xtol=1e-15) for x in 0.2 * np.sin(3 * solution.time)]
    assert solution["p"] == pytest.approx(p, abs=1e-11)
    reference = model.run(duration=1.0, points=11, solver="bdf", rtol=1e-9)
    assert solution["w"] == pytest.approx(reference["w"], abs=1e-8)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_run_ends_with_a_sentence_where_the_value_ends(solver: str) -> None:
    try:
        message = pushed("p^2 - 1 + t", "p", start=1.0).run(duration=2.0, solver=solver).message
    except stiffmbs.SolverError as error:
        message = str(error)
    assert message.startswith("stopped at t = ")
    assert "the state 'p' has no value" in message
    assert float(message.split("t = ")[1].split(" s")[0]) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize(
    ("zero", "told"),
    [
        ("p^2 + 1", "the state 'p' has no value: Newton's iteration finds no zero of its equation from p = 0.5"),
        ("cart.x", "the state 'p' has no unique value: the derivative of its equation by the state is zero at p = 0.5"),
        ("log(p - 1)", "the equation of the state 'p' has no finite value at p = 0.5"),
    ],
)
def test_a_start_without_a_value_is_refused(zero: str, told: str) -> None:
    with pytest.raises(stiffmbs.AssemblyError, match=told.replace("(", r"\(")):
        pushed(zero, "p", start=0.5).run(duration=0.1)
