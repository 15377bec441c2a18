"""Relaxation lengths: a lag of the first order over the way, a spring at rest; and what USE_MODE and TYRESIDE ask for."""

import math

import numpy as np
import pytest

from stiffmbs import InputError
from stiffmbs.elements.tyres.property_file import VERSIONS
from stiffmbs.spatial import (
    AppliedTorque,
    Body,
    Drive,
    FialaTyre,
    MagicFormulaTyre,
    Marker,
    Model,
    Orientation,
    Revolute,
)
from stiffmbs.tyres import TyreProperties

from .wheels import SAMPLE, reported, wheel

LENGTHS = (0.4, 0.7)
FIALA = {"radius": 0.3, "stiffness": 2e5, "damping": 3000, "slip_stiffness": 8e4, "cornering_stiffness": 6e4,
         "mu_static": 1, "mu_sliding": 0.8}  # fmt: skip
LOAD = 4000.0
SMALL = {**SAMPLE, "FNOMIN": LOAD, "UNLOADED_RADIUS": 0.3, "VERTICAL_STIFFNESS": 2e5, "VERTICAL_DAMPING": 3000,
         "PKX1": 20.0, "PKY1": -14.0, "PTX1": 1.9, "PTX2": 0.2, "PTX3": 0.5, "PTY1": 1.8, "PTY2": 1.9}  # fmt: skip
AXLE = {"z": (0, 1, 0)}


def gliding(tyre, speed=20.0, gravity=(0.0, 0.0, -9.81), sideways=None):
    """A wheel on a fork that keeps its heading; at a speed, or free to move, with a motion to the side if asked."""
    model = Model("wheel", gravity=gravity)
    place = {"position": (0, 0, 0.2805), "velocity": (speed, 0, 0)}
    model.add("fork", Body(mass=380, inertia=(5, 6, 7), **place))
    model.add("wheel", Body(mass=20, inertia=(0.7, 1.2, 0.7), **place, omega=(0, speed / 0.2935, 0)))
    model.add("upright", Orientation(i="fork", j="ground"))
    model.add("pin", Revolute(i=Marker(body="wheel", orientation=AXLE), j=Marker(body="fork", orientation=AXLE)))
    model.add("tyre", tyre)
    if sideways:
        model.add("along", Drive(coordinate="fork.x", i="fork", velocity=str(speed)))
        model.add("across", Drive(coordinate="fork.y", i="fork", position=sideways))
    return model


@pytest.mark.long
def test_the_lateral_slip_lags_by_its_relaxation_length():
    speed, rate, swing, (_, length) = 20.0, 15.0, 0.01, LENGTHS
    tyre = FialaTyre(i="wheel", **FIALA, relaxation=LENGTHS)
    model = gliding(tyre, speed, sideways=f"{swing}*sin({rate}*t)")
    found = model.run(duration=2, output=0.01, rtol=1e-8)
    late = found.time > 1.5
    slip = swing * rate / speed / (1 + 1j * rate * length / speed)
    expected = np.real(slip * np.exp(1j * rate * found.time))
    assert np.tan(found["tyre.slip_angle"][late]) == pytest.approx(expected[late], abs=1e-6)
    assert found["tyre.deflection_y"][late] == pytest.approx(length * expected[late], abs=1e-6)


@pytest.mark.long
def test_the_longitudinal_slip_lags_by_its_relaxation_length():
    tyre = FialaTyre(i="wheel", **FIALA, relaxation=LENGTHS)
    model = gliding(tyre, 20.0, sideways="0")
    model.add("turn", Drive(joint="pin", velocity="20/0.2935*(1 + 0.02*step(t, 1, 0, 1.0001, 1))"))
    found = model.run(duration=1.2, output=0.002, rtol=1e-8)
    slip, before = found["tyre.slip"], found["tyre.slip"][found.time < 1][-1]
    late = found.time > 1.0005
    grown = (slip[late] - before) / (slip[-1] - before)
    expected = 1 - np.exp(-20 * (found.time[late] - 1.00005) / LENGTHS[0])
    assert slip[-1] - before == pytest.approx(0.02, rel=1e-3)
    assert grown == pytest.approx(expected, abs=2e-3)


def test_lengths_of_the_magic_formula():
    from sympy import Symbol, lambdify

    from stiffmbs.elements.tyres.magic_formula import relaxation_lengths

    p = type("Numbers", (), TyreProperties(coefficients={**SMALL, "PKY3": 0.9}).in_equations())
    load, camber = Symbol("load"), Symbol("camber")
    along, across = lambdify([load, camber], relaxation_lengths(p, load, camber, lambda x: x))(5000.0, 0.1)
    assert along == pytest.approx(5000 * (1.9 + 0.2 * 0.25) * math.exp(-0.5 * 0.25) * 0.3 / LOAD)
    assert across == pytest.approx(1.8 * math.sin(2 * math.atan(1.25 / 1.9)) * (1 - 0.9 * 0.1) * 0.3)


@pytest.mark.parametrize(
    "tyre",
    [
        FialaTyre(i="wheel", **FIALA, relaxation=LENGTHS),
        pytest.param(MagicFormulaTyre(i="wheel", properties={"coefficients": SMALL}), marks=pytest.mark.long),
    ],
    ids=["fiala", "magic formula"],
)
def test_a_blocked_wheel_stands_on_a_slope(tyre):
    model = gliding(tyre, 0.0, gravity=(1.5, 0.4, -9.7))
    model.add("blocked", Drive(joint="pin", velocity="0"))
    found = model.run(duration=4, output=0.5)
    for direction, force in (("x", "longitudinal"), ("y", "lateral")):
        assert abs(found[f"fork.v{direction}"][-1]) < 1e-4
        assert found[f"tyre.{force}"][-1] == pytest.approx(-400 * {"x": 1.5, "y": 0.4}[direction], rel=1e-3)


@pytest.mark.long
def test_a_sliding_wheel_does_not_wind_up_its_deflection():
    model = gliding(FialaTyre(i="wheel", **FIALA, relaxation=LENGTHS), 0.0)
    model.add("spun", Drive(joint="pin", velocity="60*step(t, 0, 0, 0.1, 1)"))
    model.add("held", Drive(coordinate="fork.x", i="fork", velocity="0"))
    assert abs(model.run(duration=2, output=0.1)["tyre.deflection_x"]).max() < LENGTHS[0]


@pytest.mark.long
def test_from_a_standstill_to_speed_and_back_without_chatter():
    model = gliding(MagicFormulaTyre(i="wheel", properties={"coefficients": SMALL}), 0.0)
    torque = "900*step(t, 0.5, 0, 1, 1) - 1800*step(t, 12, 0, 12.5, 1)*tanh(wy(wheel, fork)/0.5)"
    model.add("drive", AppliedTorque(i="wheel", j="fork", torque=(0, torque, 0)))
    found = model.run(duration=26, output=0.05)
    assert found["fork.vx"].max() > 80 * 900 / 1000 * 0.35
    assert abs(found["fork.vx"][-1]) < 0.2
    assert found.solver["steps"] < 3500


@pytest.mark.long
def test_steady_slip_is_the_limit():
    lagging = MagicFormulaTyre(i="wheel", properties={"coefficients": SMALL})
    steady = MagicFormulaTyre(i="wheel", properties={"coefficients": SMALL}, transient=False)
    one, other = (gliding(tyre, sideways="0.5*t").run(duration=2, output=1.0, rtol=1e-8) for tyre in (lagging, steady))
    for name in ("longitudinal", "lateral", "aligning", "overturning"):
        assert one[f"tyre.{name}"][-1] == pytest.approx(other[f"tyre.{name}"][-1], rel=1e-4)
    assert "tyre.deflection_x" not in other.channels


def at_slip(coefficients=SMALL, use_mode=4, **fields):
    tyre = MagicFormulaTyre(
        i="wheel", properties={"coefficients": coefficients, "use_mode": use_mode, **fields.pop("of", {})}, **fields
    )
    return reported(wheel(tyre, 0.3, 0.02, slip_angle=0.05, camber=0.02, spin=36.0))


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    ("mode", "acting"),
    [(0, ""), (1, "longitudinal rolling"), (2, "lateral overturning aligning"),
     (3, "longitudinal lateral overturning rolling aligning")],
)  # fmt: skip
def test_use_mode_chooses_the_forces(mode, acting):
    found = at_slip(use_mode=mode)
    names = ("longitudinal", "lateral", "overturning", "rolling", "aligning")
    assert {name for name in names if found[name]} == set(acting.split())
    assert found["load"] > 3000


@pytest.mark.long
def test_uncombined_forces_are_those_of_each_slip_alone():
    found, by = at_slip(use_mode=3), TyreProperties(coefficients=SMALL)
    alone = by.wrench(found["load"], found["slip"], 0.0, found["camber"], 10.0)
    across = by.wrench(found["load"], 0.0, found["slip_angle"], found["camber"], 10.0)
    assert found["longitudinal"] != pytest.approx(at_slip()["longitudinal"], rel=1e-3)
    # the weights of combined slip are 1 where the other slip is zero, but for their shifts
    assert found["longitudinal"] == pytest.approx(alone["longitudinal"], rel=1e-6)
    assert found["overturning"] == pytest.approx(across["overturning"], rel=0.05)


@pytest.mark.long
def test_a_mode_below_zero_mirrors_the_tyre():
    mirrored = at_slip(use_mode=-4)
    assert at_slip()["lateral"] != pytest.approx(mirrored["lateral"], rel=1e-3)
    assert mirrored == pytest.approx(at_slip(hand=-1), rel=1e-12)


@pytest.mark.long
def test_the_other_side_mirrors_the_tyre():
    plain, mirrored = at_slip(), at_slip(hand=-1)
    left = {"side": "left"}
    for same in (at_slip(of=left, side="right"), at_slip(use_mode=-4, of=left, side="left")):
        assert same == pytest.approx(mirrored, rel=1e-12)
    for same in (at_slip(of=left, side="left"), at_slip(of=left), at_slip(use_mode=-4, of=left, side="right")):
        assert same == pytest.approx(plain, rel=1e-12)


def test_lengths_that_are_asked_for_and_not_there():
    without = {name: value for name, value in SMALL.items() if not name.startswith("PT")}
    assert "asks for relaxation lengths" in " ".join(TyreProperties(coefficients=without, use_mode=14).notes())
    with pytest.raises(InputError, match="without PTX1 and PTY1, expected relaxation lengths"):
        MagicFormulaTyre(i="wheel", properties={"coefficients": without}, transient=True)
    with pytest.raises(InputError, match="found USE_MODE = 25, expected 0 to 4"):
        TyreProperties(coefficients=SMALL, use_mode=25)


@pytest.mark.parametrize(
    ("mode", "same", "said"),
    [
        (24, 14, ["nonlinear transient slip: slips lag by relaxation lengths, as with 14"]),
        (-22, -12, ["nonlinear transient slip"]),
        (334, 14, ["rigid ring dynamics", "contact method 3"]),
        (104, 4, ["contact method 1"]),
    ],
)
def test_digits_of_use_mode_that_are_replaced_are_noted(mode, same, said):
    """Dynamics beyond relaxation lengths, and contact methods of MF-Tyre 6.1 by a third digit."""
    later = {"NOMPRES": 2e5, "LONGITUDINAL_STIFFNESS": 3e5, "LATERAL_STIFFNESS": 1e5}
    known = VERSIONS["6.1"].numbers
    of_61 = {name: x for name, x in {**SMALL, **later}.items() if name in known}
    file = {"coefficients": of_61, "version": "6.1"} if mode > 100 else {"coefficients": SMALL}
    tyre, simple = (TyreProperties(**file, use_mode=each) for each in (mode, same))
    notes = [note for note in tyre.notes() if note not in set(simple.notes())]
    assert len(notes) == len(said) and all(words in note for words, note in zip(said, notes, strict=True))
    assert (tyre.is_transient, tyre.in_equations()) == (simple.is_transient, simple.in_equations())
    with pytest.raises(InputError, match="found USE_MODE = 614"):
        TyreProperties(**file, use_mode=614)
