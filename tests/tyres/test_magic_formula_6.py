"""The Magic Formula 6.1 and 6.2: published tables, turn slip, and the tyre on its wheel."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError
from stiffmbs.spatial import Body, MagicFormulaTyre, Model
from stiffmbs.studies.tyre_curves import TyreSweep, tyre_curves
from stiffmbs.tyres import TyreProperties

from .wheels import reported, wheel

PUBLISHED = Path(__file__).parents[3] / "shared" / "references" / "tyres6"
FILES = ("invented_car_mf62", "invented_motorcycle_rear_mf62")
needs_tables = pytest.mark.skipif(not PUBLISHED.is_dir(), reason="the published tyres are not here")
NUMBERS = {
    "FNOMIN": 4000.0, "UNLOADED_RADIUS": 0.33, "VERTICAL_STIFFNESS": 2e5, "VERTICAL_DAMPING": 50.0, "WIDTH": 0.2,
    "ASPECT_RATIO": 0.5, "NOMPRES": 2.4e5, "LONGITUDINAL_STIFFNESS": 3.5e5, "LATERAL_STIFFNESS": 1.1e5, "Q_V1": 7e-4,
    "Q_V2": 0.04, "Q_FZ2": 16.0, "Q_FCX": 0.13, "Q_FCY": 0.12, "PFZ1": 0.7, "BREFF": 8.0, "DREFF": 0.27, "FREFF": 0.06,
    "Q_RE0": 0.998, "PCX1": 1.6, "PDX1": 1.1, "PDX2": -0.1, "PKX1": 22.0, "PKX3": 0.2, "PCY1": 1.4, "PDY1": 1.0,
    "PDY2": -0.12, "PKY1": -20.0, "PKY2": 1.8, "PKY3": 0.5, "PKY4": 1.95, "PKY6": -0.9, "PKY7": -0.2, "QBZ1": 10.0,
    "QCZ1": 1.1, "QDZ1": 0.1, "QDZ8": -0.15, "QSX3": 0.05, "QSY1": 0.01, "RBX1": 12.0, "RBX2": 9.0, "RCX1": 1.0, "RBY1": 11.0,
    "RBY2": 8.0, "RCY1": 1.0, "PPX1": -0.3, "PPY1": 0.36, "PPY2": 0.8, "PPY3": -0.15,
}  # fmt: skip
TURNING = {
    "PDXP1": 0.4, "PKYP1": 1.0, "PDYP1": 0.4, "PHYP1": 1.0, "PHYP2": 0.15, "PHYP4": -4.0, "PECP1": 0.5, "QDTP1": 10.0,
    "QCRP1": 0.2, "QCRP2": 0.1, "QBRP1": 0.1, "QDRP1": 1.0,
}  # fmt: skip
TYRE = TyreProperties(coefficients=NUMBERS, version="6.2")


def table(name):
    """A published tyre, its states by name, and its results."""
    reference = json.loads((PUBLISHED / f"{name}.json").read_text())
    states = dict(zip(reference["state_columns"], np.array(reference["states"]).T, strict=True))
    return TyreProperties.from_file(PUBLISHED / f"{name}.tir"), states, reference


def largest_error(found, expected):
    return np.abs(found - np.array(expected)).max() / np.abs(expected).max()


@needs_tables
@pytest.mark.parametrize("name", FILES)
def test_every_column_of_the_published_tables(name):
    tyre, states, reference = table(name)
    found = tyre.steady_state(**states)
    assert {column: largest_error(found[column], x) for column, x in reference["results"].items()} == {
        column: pytest.approx(0, abs=1e-11) for column in reference["results"]
    }


@needs_tables
@pytest.mark.parametrize("name", FILES)
def test_radii_of_the_same_tyre_by_version_61(name):
    tyre, states, reference = table(name)
    found = tyre.model_copy(update={"version": "6.1"}).steady_state(**states)
    for column, x in reference["results_as_fittyp61"].items():
        assert largest_error(found[column], x) < 1e-11, column


@needs_tables
@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("row", [22, 40, 66])
def test_a_wheel_has_the_load_and_the_forces_of_the_table(name, row):
    """A wheel at the loaded radius, spin, slip and camber of a row carries its load, although this depends on the forces."""
    tyre, states, reference = table(name)
    state = {column: float(x[row]) for column, x in states.items()}
    expected = {column: x[row] for column, x in reference["results"].items()}
    element = MagicFormulaTyre(i="wheel", properties=tyre, pressure=state["p"], transient=False)
    model = wheel(element, expected["Rl"], 0.0, state["alpha"], state["gamma"], state["Vx"], expected["omega"])
    found = reported(model)
    assert found["load"] == pytest.approx(state["Fz"], rel=1e-6)
    assert found["deflection"] == pytest.approx(expected["rho"], rel=1e-9)
    names = {"longitudinal": "Fx", "lateral": "Fy", "overturning": "Mx", "rolling": "My", "aligning": "Mz"}
    for channel, column in names.items():
        scale = np.abs(reference["results"][column]).max()
        assert found[channel] == pytest.approx(expected[column], rel=1e-6, abs=1e-6 * scale), channel


def slope(tyre, h=1e-6, of="Fy", **state):
    """The central difference of a result by the one entry of the state that is a pair (value, name)."""
    (name,) = (name for name, x in state.items() if x is None)
    high, low = (tyre.steady_state(4000.0, **{**state, name: sign * h})[of] for sign in (1, -1))
    return (high - low) / (2 * h)


@pytest.mark.long
def test_stiffnesses_are_slopes_of_the_forces_at_any_pressure():
    for p in (1.9e5, 2.4e5, 2.9e5):
        state = TYRE.steady_state(4000.0, p=p)
        assert slope(TYRE, of="Fx", p=p, kappa=None) == pytest.approx(state["Kxk"], rel=1e-8)
        assert slope(TYRE, p=p, alpha=None) == pytest.approx(state["Kya"], rel=1e-8)
        assert slope(TYRE, p=p, gamma=None) == pytest.approx(state["Kyg0"], rel=1e-6)


@pytest.mark.long
def test_camber_with_and_without_turn_slip_has_one_stiffness():
    """Camber is turning slip reduced by epsilon_gamma, which the stiffness of spin divides by again (4.89)."""
    turning = TyreProperties(
        coefficients={**NUMBERS, **TURNING, "DREFF": 0.0, "FREFF": 0.0, "Q_RE0": 1.0, "Q_V1": 0.0}, version="6.1"
    )
    state = turning.steady_state(4000.0)
    assert slope(turning, gamma=None, phit=0.0) == pytest.approx(state["Kyg0"], rel=1e-5)
    residual = slope(turning, of="Mzr", gamma=None, phit=0.0)
    assert residual == pytest.approx(slope(turning, of="Mzr", gamma=None), rel=1e-5)


@pytest.mark.long
def test_a_tight_turn_at_no_slip_has_the_torque_of_parking():
    """Mz tends to q_Crp1 mu_y R Fz sqrt(Fz/Fz0) (4.95), against the turn, and the side force fades."""
    turning = TyreProperties(coefficients={**NUMBERS, **TURNING}, version="6.2")
    found = turning.steady_state(3000.0, phit=[-300.0, 300.0])
    most = 0.2 * found["muy"] * 0.33 * 3000 * math.sqrt(3000 / 4000)
    assert found["Mzr"] == pytest.approx([most[0], -most[1]], rel=0.3)
    assert np.abs(found["Fy"]).max() < 0.1 * 3000
    parked = turning.steady_state(3000.0, phit=300.0, Vx=-5.0)
    assert float(parked["omega"]) < 0


def test_a_tyre_without_coefficients_of_turn_slip_or_pressure_refuses_them():
    with pytest.raises(InputError, match="found turn slip for a tyre without its coefficients"):
        TYRE.steady_state(4000.0, phit=0.1)
    before = {
        name: x
        for name, x in NUMBERS.items()
        if name[:2] not in ("PP", "Q_") and name not in ("PFZ1", "PKY4", "PKY6", "PKY7")
    }
    before = {
        name: x
        for name, x in before.items()
        if name not in ("WIDTH", "ASPECT_RATIO", "NOMPRES") and "AL_STIFFNESS" not in name
    }
    older = TyreProperties(coefficients={**before, "VERTICAL_STIFFNESS": 2e5})
    with pytest.raises(InputError, match=r"found a pressure for a tyre of version 5\.2"):
        older.steady_state(4000.0, p=2e5)
    with pytest.raises(InputError, match=r"pressure: found one for a tyre of version 5\.2"):
        MagicFormulaTyre(i="wheel", properties=older, pressure=2e5)
    with pytest.raises(InputError, match="found a pressure of 0 Pa"):
        TYRE.steady_state(4000.0, p=0.0)
    with pytest.raises(InputError, match="found a load of -1 N"):
        TYRE.steady_state([10.0, -1.0])
    with pytest.raises(InputError, match="found a load of inf N"):
        TYRE.steady_state([10.0, np.inf])
    with pytest.raises(InputError, match="found a pressure of inf Pa"):
        TYRE.steady_state(4000.0, p=np.inf)
    with pytest.raises(InputError, match=r"found a friction factor of -0\.5, expected zero or a positive number"):
        TYRE.wrench(4000.0, friction=[1.0, -0.5])
    with pytest.raises(InputError, match="found Q_FZ2 = 100, expected less than 68"):
        TyreProperties(coefficients={**NUMBERS, "Q_FZ2": 100.0}, version="6.1")


@pytest.mark.parametrize("pressure", [2.3, 2300.0, 2.3e8])
def test_a_steady_state_refuses_the_pressures_that_a_wheel_refuses(pressure):
    message = re.escape(f"found a pressure of {pressure:g} Pa, expected 10000 to 5e+06 Pa")
    with pytest.raises(InputError, match=message):
        TYRE.steady_state(4000.0, p=[2.3e5, pressure])
    with pytest.raises(InputError, match=message):
        tyre_curves(TYRE, TyreSweep(pressure=(pressure,)))


@pytest.mark.parametrize(("name", "words"), [("alpha", "slip angle"), ("gamma", "camber")])
@pytest.mark.parametrize("degrees", [5.0, -95.0, float("nan")])
def test_a_steady_state_refuses_angles_in_degrees(name, words, degrees):
    with pytest.raises(InputError, match=rf"found a {words} of {degrees:g} rad, expected -1\.5708 to 1\.5708 rad"):
        TYRE.steady_state(4000.0, **{name: [0.0, degrees]})


@pytest.mark.parametrize("hand", [0.5, -2.0])
def test_a_hand_other_than_that_of_either_side_is_refused(hand):
    with pytest.raises(InputError, match=f"hand: found {hand:g}, expected 1 or -1"):
        MagicFormulaTyre(i="wheel", properties=TYRE, hand=hand)


@pytest.mark.long
def test_a_standing_tyre_has_no_forces_of_rolling():
    """At rest there is neither camber thrust, residual torque nor rolling resistance, and nothing is divided by zero."""
    found = reported(wheel(MagicFormulaTyre(i="wheel", properties=TYRE), 0.33, 0.02, 0.0, 0.1, 0.0, 0.0))
    assert found["load"] > 3000
    for name in ("longitudinal", "lateral", "rolling", "aligning", "slip", "slip_angle"):
        assert found[name] == pytest.approx(0, abs=1e-9), name


RIG = """
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {V: 20, lean: 40 deg, steer: 1 deg, R: 0.31}
bodies:
  sledge: {mass: 10, inertia: [1, 1, 1], position: [0, 0, "R*cos(lean)"], velocity: [V, 0, 0]}
  fork: {mass: 130, inertia: [1, 1, 1], position: [0, 0, "R*cos(lean)"], velocity: [V, 0, 0]}
  wheel:
    mass: 15
    inertia: [0.4, 0.7, 0.4]
    position: [0, 0, "R*cos(lean)"]
    orientation: {x: ["cos(steer)", "sin(steer)", 0], y: ["-sin(steer)*cos(lean)", "cos(steer)*cos(lean)", "sin(lean)"]}
    velocity: [V, 0, 0]
    omega: [0, "V/0.31", 0]
joints:
  guide: {type: prismatic, i: {body: sledge, orientation: {z: [1, 0, 0]}}, j: {body: ground, orientation: {z: [1, 0, 0]}}}
  column: {type: prismatic, i: fork, j: sledge}
  axle:
    type: revolute
    i: {body: wheel, orientation: {z: [0, 1, 0]}}
    j: {body: fork, orientation: {z: ["-sin(steer)*cos(lean)", "cos(steer)*cos(lean)", "sin(lean)"]}}
  pull: {type: drive, joint: guide, velocity: V}
forces:
  tyre: {type: magic_formula_tyre, i: wheel, properties: {coefficients: COEFFICIENTS, version: VERSION}, pressure: 0.25 MPa}
run: {duration: 1 s, rtol: 1e-7, output: 0.05 s}
"""


def rig(version="6.2", **settings):
    text = RIG.replace("COEFFICIENTS", json.dumps({**NUMBERS, "VERTICAL_DAMPING": 4000.0})).replace(
        "VERSION", f'"{version}"'
    )
    return stiffmbs.run(stiffmbs.read_scene(text), **settings)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("version", ["6.1", "6.2"])
def test_a_motorcycle_tyre_at_40_degrees_of_camber_rolls_by_every_solver(version):
    """With relaxation lengths, from zero deflection on, the tyre arrives at the steady state of its equations."""
    runs = {solver: rig(version, **settings) for solver, settings in {
        "bdf": {"solver": "bdf"}, "radau": {"solver": "radau"}, "dop853": {"solver": "projected", "scheme": "dop853"},
    }.items()}  # fmt: skip
    for solver, solution in runs.items():
        last = {name: solution[f"tyre.{name}"][-1] for name in ("load", "slip", "slip_angle", "camber", "deflection")}
        assert last["camber"] == pytest.approx(math.radians(40), abs=1e-9), solver
        assert last["load"] == pytest.approx(145 * 9.81, rel=1e-4), solver
        state = TyreProperties(coefficients=NUMBERS, version=version).steady_state(
            last["load"], last["slip"], last["slip_angle"], last["camber"], p=2.5e5, Vx=solution["sledge.vx"][-1]
        )
        for channel, column in (("longitudinal", "Fx"), ("lateral", "Fy"), ("overturning", "Mx"), ("aligning", "Mz")):
            assert solution[f"tyre.{channel}"][-1] == pytest.approx(float(state[column]), rel=2e-4, abs=0.05), (
                solver,
                channel,
            )
        assert last["deflection"] == pytest.approx(float(state["rho"]), rel=1e-5), solver
        for channel in ("tyre.load", "tyre.lateral", "wheel.wy", "tyre.deflection_y"):
            assert solution[channel] == pytest.approx(runs["bdf"][channel], rel=1e-4, abs=1e-4), (solver, channel)


REVERSING = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  fork: {mass: 380, inertia: [100, 100, 100], position: [0, 0, 0.31], velocity: [5, 0, 0]}
  wheel:
    {mass: 20, inertia: [0.5, 1, 0.5], position: [0, 0, 0.31], orientation: {x: [1, 0, 0], y: [0, 0.8, 0.6]},
     velocity: [5, 0, 0], omega: [0, 15.6, 0]}
joints:
  keep: {type: parallel, i: fork, j: ground}
  axle: {type: revolute, i: {body: wheel, orientation: {z: [0, 1, 0]}}, j: {body: fork, orientation: {z: [0, 0.8, 0.6]}}}
forces:
  tyre: {type: magic_formula_tyre, i: wheel, properties: {coefficients: COEFFICIENTS, version: "6.2"}, turn_slip: true}
  push: {type: force, i: fork, force: ["-1500*step(t, 0.2, 0, 0.4, 1)", "200*step(t, 0.2, 0, 0.4, 1)", 0]}
  turn: {type: torque, i: fork, torque: [0, 0, "30*step(t, 0.2, 0, 0.4, 1) - 100*fork.wz"]}
run: {duration: 3 s, rtol: 1e-7, output: 0.05 s}
"""


@pytest.mark.long
def test_a_cambered_wheel_stops_and_reverses_while_it_is_steered():
    """It falls on the road at the start, comes to a standstill and rolls backward; the solvers agree, and all is finite."""
    text = REVERSING.replace("COEFFICIENTS", json.dumps({**NUMBERS, **TURNING, "VERTICAL_DAMPING": 3000.0}))
    scene = stiffmbs.read_scene(text)
    runs = [
        stiffmbs.run(scene, **settings)
        for settings in ({"solver": "bdf"}, {"solver": "radau"}, {"solver": "projected"})
    ]
    for solution in runs:
        assert solution.success, solution.message
        assert solution["fork.vx"][-1] < -1
        assert np.isfinite(solution["tyre.aligning"]).all()
        for channel in ("fork.x", "fork.y", "fork.vx"):
            assert solution[channel] == pytest.approx(runs[0][channel], abs=2e-4), channel


@pytest.mark.long
def test_a_turning_wheel_has_the_turn_slip_of_its_yaw_rate_and_a_mirrored_one_the_opposite():
    """phi_t is the yaw rate over the speed of the contact point, the camber's part included."""
    turning = TyreProperties(coefficients={**NUMBERS, **TURNING}, version="6.2")
    speed, yaw, found = 18.0, 1.5, []
    for hand in (1, -1):
        gamma, alpha = 0.1 * hand, 0.05 * hand
        axis = (0, math.cos(gamma), math.sin(gamma))
        model = Model("wheel", gravity=(0, 0, -9.81))
        omega = (0, 60 + yaw * hand * math.sin(gamma), yaw * hand * math.cos(gamma))
        model.add(
            "wheel",
            Body(
                mass=20, inertia=(0.7, 1.2, 0.7), position=(0, 0, 0.305 * math.cos(gamma)),
                orientation={"x": (1, 0, 0), "y": axis}, velocity=(speed, speed * math.tan(alpha), 0), omega=omega,
            ),
        )  # fmt: skip
        model.add("tyre", MagicFormulaTyre(i="wheel", properties=turning, hand=hand, turn_slip=True, transient=False))
        found.append(reported(model))
    one, other = found
    state = turning.steady_state(
        one["load"],
        one["slip"],
        one["slip_angle"],
        one["camber"],
        Vx=speed,
        phit=yaw * math.cos(one["slip_angle"]) / speed,
    )
    without = turning.steady_state(one["load"], one["slip"], one["slip_angle"], one["camber"], Vx=speed)
    for channel, column in {
        "longitudinal": "Fx",
        "lateral": "Fy",
        "aligning": "Mz",
        "overturning": "Mx",
        "deflection": "rho",
    }.items():
        assert one[channel] == pytest.approx(float(state[column]), rel=1e-6), channel
        sign = 1 if channel in ("longitudinal", "deflection") else -1
        assert other[channel] == pytest.approx(sign * one[channel], rel=1e-10), channel
    assert abs(one["lateral"] - float(without["Fy"])) > 10
