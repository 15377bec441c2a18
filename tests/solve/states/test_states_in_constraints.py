"""States in drives and constraints: against minimal coordinates, about a state, and what is refused; states in mirrored parts."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import AlgebraicState, Body, ConstraintEquation, Drive, Marker, Model, Prismatic, Revolute, State


def crane(start=1.0, push="0.2*sin(3*t)"):
    """A trolley that is driven to follow a state, with a load on it that the state feels."""
    model = Model("crane", gravity=(0, -9.81))
    model.add("cart", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("bob", Body(mass=1, inertia=0.01, position=(0, -0.5)))
    model.add("pin", Revolute(i=Marker(body="bob", point=(0, 0.5)), j="cart"))
    model.add("z", State(rate="w - 0.5*z + 0.3*bob.x"))
    model.add("w", State(rate=f"-4*z - 0.3*w + 0.1*bob.vx + {push}", start=start))
    return model


def rates(t, y, push):
    """The load's angle and rate, z and w in minimal coordinates."""
    angle, omega, z, w = y
    slope = 0.5 + 0.2 * z
    at = 0.5 * z + 0.1 * z * z + 0.5 * np.sin(angle)
    z_rate = w - 0.5 * z + 0.3 * at
    velocity = slope * z_rate + 0.5 * np.cos(angle) * omega
    w_rate = -4 * z - 0.3 * w + 0.1 * velocity + push(t)
    z_second = w_rate - 0.5 * z_rate + 0.3 * velocity
    trolley = slope * z_second + 0.2 * z_rate**2
    return np.array([omega, -(9.81 * 0.5 * np.sin(angle) + 0.5 * trolley * np.cos(angle)) / 0.26, z_rate, w_rate])


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "settings",
    [{"solver": "projected"}, *({"solver": "bdf", "formulation": name} for name in ("SI2", "I3", "SI1", "index1"))],
    ids=lambda s: s.get("formulation", "dop853"),
)
@pytest.mark.parametrize("drive", ["drive", "equation"])
def test_a_drive_that_follows_a_state(settings, drive):
    model = crane()
    if drive == "drive":
        model.add("motor", Drive(joint="rail", position="0.5*z + 0.1*z^2"))
    else:
        model.add("motor", ConstraintEquation(zero="cart.x - 0.5*z - 0.1*z^2"))
    solution = model.run(duration=1.0, points=11, rtol=1e-8, **settings)
    start = [0, solution["bob.omega"][0], 0, 1.0]
    exact = solve_ivp(
        rates, (0, 1), start, args=(lambda t: 0.2 * np.sin(3 * t),), t_eval=solution.time, rtol=1e-11, atol=1e-12
    )
    assert abs(solution["bob.angle"] - exact.y[0]).max() < (1e-5 if settings.get("formulation") == "I3" else 1e-6)
    assert abs(solution["z"] - exact.y[2]).max() < 1e-6
    assert abs(solution["cart.x"] - 0.5 * solution["z"] - 0.1 * solution["z"] ** 2).max() < 1e-11


def test_modes_about_an_equilibrium_with_a_driven_trolley():
    model = crane(start=0.0, push="0.02")
    model.add("motor", Drive(joint="rail", position="0.5*z + 0.1*z^2"))
    found = stiffmbs.equilibrium(model)
    at = np.array([found.channels[name] for name in ("bob.angle", "bob.omega", "z", "w")])
    assert abs(rates(0, at, lambda t: 0.02)).max() < 1e-9
    step = 1e-6
    ways = [
        (rates(0, at + step * way, lambda t: 0.02) - rates(0, at - step * way, lambda t: 0.02)) for way in np.eye(4)
    ]
    expected = np.linalg.eigvals(np.array(ways).T / (2 * step))
    modes = stiffmbs.modes(model, start_from=found.solution)
    values = np.array([value for mode in modes.modes for value in mode.eigenvalues])
    assert np.sort_complex(values) == pytest.approx(np.sort_complex(expected), abs=1e-7)


def test_a_velocity_that_follows_a_state():
    model = Model("driven")
    model.add("cart", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("z", State(rate="sin(t)"))
    model.add("motor", Drive(joint="rail", velocity="0.5*z"))
    for solver in ("bdf", "projected"):
        solution = model.run(duration=2.0, points=11, rtol=1e-9, solver=solver)
        t = solution.time
        assert solution["cart.x"] == pytest.approx(0.5 * (t - np.sin(t)), abs=1e-8)
        assert solution["motor.fx"] == pytest.approx(np.sin(t), abs=1e-8)


@pytest.mark.parametrize(
    ("state", "told"),
    [
        (State(rate="bob.vx - z"), "found a state whose rate follows velocities in a constraint of positions"),
        (State(rate="fy(pin) - z"), "found a reaction in its equations"),
        (AlgebraicState(zero="z + z^3 - bob.x"), "found the algebraic state 'z' in a constraint"),
    ],
)
def test_what_a_constraint_cannot_follow_is_refused(state, told):
    model = Model("refused")
    model.add("cart", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("bob", Body(mass=1, inertia=0.01, position=(0, -0.5)))
    model.add("pin", Revolute(i=Marker(body="bob", point=(0, 0.5)), j="cart"))
    model.add("z", state)
    model.add("motor", Drive(joint="rail", position="0.5*z"))
    with pytest.raises(stiffmbs.InputError, match=f"motor: .*{told}"):
        model.run(duration=0.1)


def test_kinematic_analysis_of_what_follows_a_state_is_refused():
    model = crane()
    model.add("motor", Drive(joint="rail", position="0.5*z"))
    model.add("turn", Drive(joint="pin", position="t"))
    with pytest.raises(stiffmbs.InputError, match="'motor': found a state in a drive"):
        model.run(duration=0.1, solver="kinematic")


MIRRORED = """
dimensions: 3
gravity: [0, 0, -9.81]
parts:
  arm:
    bodies:
      rod: {mass: 1, inertia: [.1, .2, .3], position: [0.1, 0.5, 0.2], velocity: [0.2, 0.3, 0.1], omega: [0.5, 0.3, -0.4]}
    states:
      lag: {rate: "(dy(rod, mount) - 0.5 - lag)/0.1 + 0.2*wz(rod, mount)", start: 0.1}
      out: {numerator: [1, 2], denominator: [0.1, 1], input: "vx(rod, mount)"}
      alg: {zero: "alg + alg^3 - lag - dx(rod, mount)"}
    joints:
      pin: {type: spherical, i: {body: rod, point: [-0.1, -0.5, 0]}, j: {body: mount, point: [0, 0, 0.2]}}
    forces:
      pull: {type: force, i: rod, force: ["alg - 30*lag", "-30*lag - 2*out", "out"]}
      twist: {type: torque, i: rod, torque: ["lag", "alg", "-0.3*lag"]}
use: {left: {part: arm}, right: {part: arm, mirror: y}}
run: {duration: 0.5 s, output: 50 ms}
"""


@pytest.mark.long
def test_states_of_a_mirrored_part_are_those_of_the_part():
    solution = stiffmbs.run(stiffmbs.read_scene(MIRRORED), solver="projected")
    assert np.ptp(solution["left.lag"]) > 0.1
    for name in ("lag", "out", "alg"):
        assert solution[f"left.{name}"] == pytest.approx(solution[f"right.{name}"], abs=1e-12)
    for name, sign in (("x", 1), ("y", -1), ("z", 1), ("wx", -1), ("wy", 1), ("wz", -1)):
        assert solution[f"left.rod.{name}"] == pytest.approx(sign * solution[f"right.rod.{name}"], abs=1e-12)
