"""The Magic Formula: published properties, a published tyre, and the tyre on its wheel."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from stiffmbs.spatial import AppliedTorque, Body, MagicFormulaTyre, Model
from stiffmbs.tyres import TyreProperties

from .wheels import reported, wheel

PUBLISHED = Path(__file__).parents[3] / "shared" / "references" / "tyres"
PLAIN = {
    "FNOMIN": 4000.0, "UNLOADED_RADIUS": 0.32, "VERTICAL_STIFFNESS": 2e5, "VERTICAL_DAMPING": 0.0, "PCX1": 1.6, "PDX1": 1.1,
    "PDX2": -0.1, "PEX1": 0.3, "PKX1": 21.0, "PKX3": 0.2, "PCY1": 1.35, "PDY1": 1.0, "PDY2": -0.15, "PDY3": 2.0, "PEY1": -0.8,
    "PKY1": -14.0, "PKY2": 1.8, "PKY3": 0.4, "PVY3": -0.3, "QBZ1": 10.0, "QCZ1": 1.1, "QDZ1": 0.1, "QEZ1": -1.0,
    "RBX1": 12.0, "RBX2": -9.0, "RCX1": 1.05, "RBY1": 7.0, "RBY2": 2.5, "RCY1": 1.05,
}  # fmt: skip
"""A tyre without shifts."""
TYRE = TyreProperties(coefficients=PLAIN)
LOADS = np.array([1000.0, 4000.0, 6500.0])


@pytest.mark.long
def test_slope_peak_and_asymptote_of_the_longitudinal_force():
    """BCD = Kx at zero slip, D at the peak, D sin(C pi/2 (1 - E) ... ) at large slip; Pacejka (2012), sec. 4.3.1."""
    dfz = LOADS / 4000 - 1
    K, mu = LOADS * 21 * np.exp(0.2 * dfz), 1.1 - 0.1 * dfz
    h = 1e-7
    slope = (TYRE.wrench(LOADS, slip=h)["longitudinal"] - TYRE.wrench(LOADS, slip=-h)["longitudinal"]) / (2 * h)
    assert slope == pytest.approx(K, rel=1e-7)
    curve = TYRE.wrench(LOADS[:, None], slip=np.linspace(0, 1, 20001))["longitudinal"]
    assert curve.max(axis=1) == pytest.approx(mu * LOADS, rel=1e-7)
    B = K / (1.6 * mu * LOADS)
    far = 1e5
    bent = B * far - 0.3 * (B * far - math.pi / 2)
    assert TYRE.wrench(LOADS, slip=far)["longitudinal"] == pytest.approx(
        mu * LOADS * np.sin(1.6 * np.arctan(bent)), rel=1e-6
    )


def test_cornering_stiffness_over_load_and_camber():
    """Ky = PKY1 Fz0 sin(2 atan(Fz/(PKY2 Fz0))) (1 - PKY3 |gamma|), and the peak falls with camber squared."""
    h = 1e-7
    for camber in (0.0, 0.05):
        sides = [TYRE.wrench(LOADS, slip_angle=side * h, camber=camber)["lateral"] for side in (1, -1)]
        K = -14 * 4000 * np.sin(2 * np.arctan(LOADS / (1.8 * 4000))) * (1 - 0.4 * camber)
        assert (sides[0] - sides[1]) / (2 * h) == pytest.approx(K, rel=1e-6)
        curve = TYRE.wrench(LOADS[:, None], slip_angle=np.linspace(-1.2, 0, 20001), camber=camber)["lateral"]
        dfz = LOADS / 4000 - 1
        peak = (1 - 0.15 * dfz) * (1 - 2 * camber**2) * LOADS - 0.3 * LOADS * camber
        assert curve.max(axis=1) == pytest.approx(peak, rel=1e-6)


def test_a_tyre_without_shifts_is_symmetric():
    one = TYRE.wrench(4000, slip=0.1, slip_angle=0.05, camber=0.02)
    other = TYRE.wrench(4000, slip=0.1, slip_angle=-0.05, camber=-0.02)
    assert one["longitudinal"] == pytest.approx(other["longitudinal"], rel=1e-13)
    for name in ("lateral", "overturning", "aligning"):
        assert one[name] == pytest.approx(-other[name], rel=1e-12, abs=1e-9)


def test_combined_slip_takes_from_both_forces_and_leaves_pure_ones():
    pure = TYRE.wrench(4000, slip=0.1)["longitudinal"], TYRE.wrench(4000, slip_angle=0.08)["lateral"]
    both = TYRE.wrench(4000, slip=0.1, slip_angle=0.08)
    assert 0 < both["longitudinal"] < pure[0]
    assert pure[1] < both["lateral"] < 0


@pytest.mark.long
def test_without_combined_coefficients_forces_stay_on_the_friction_ellipse():
    bare = TyreProperties(coefficients={name: x for name, x in PLAIN.items() if name[0] != "R"})
    found = bare.wrench(4000, slip=0.3, slip_angle=0.3)
    radius = np.hypot(found["longitudinal"] / (1.1 * 4000), found["lateral"] / (1.0 * 4000))
    assert radius == pytest.approx(1, rel=1e-12)
    assert any("friction ellipse" in note for note in bare.notes())
    assert not list(TYRE.notes())


def test_combined_slip_without_coefficients_by_the_manual_of_pac2002():
    """mu_x and mu_y by the slips kappa_c and alpha_c, in the order of the manual's equations."""
    shifted = {name: x for name, x in PLAIN.items() if name[0] != "R"} | {
        "PHX1": 0.002,
        "PVX1": 0.01,
        "PHY1": -0.003,
        "PVY1": 0.02,
    }
    bare = TyreProperties(coefficients=shifted, is_pac2002=True)
    for kappa, alpha in ((0.05, 0.04), (-0.2, 0.15), (0.3, -0.3), (0.01, 0.2)):
        x, y = bare.steady_state(4000, kappa, 0.0), bare.steady_state(4000, 0.0, alpha)
        pure = TyreProperties(coefficients={**shifted, "RBX1": 1e-30})  # weights of combined slip are 1
        fx0, fy0 = float(pure.steady_state(4000, kappa)["Fx"]), float(pure.steady_state(4000, 0, alpha)["Fy"])
        svx, svy = 4000 * 0.01, 4000 * 0.02
        kappa_c = kappa + 0.002 + svx / x["Kxk"]
        alpha_c = math.sin(alpha - 0.003 + svy / y["Kya"])
        tangent = math.tan(math.acos(abs(kappa_c) / math.hypot(kappa_c, alpha_c)))
        act_x, act_y = (fx0 - svx) / 4000, (fy0 - svy) / 4000
        mu_x = 1 / math.hypot(1 / act_x, tangent / y["muy"])
        mu_y = tangent / math.hypot(1 / x["mux"], tangent / act_y)
        both = bare.steady_state(4000, kappa, alpha)
        assert both["Fx"] == pytest.approx(mu_x / abs(act_x) * fx0, rel=1e-9)
        assert both["Fy"] == pytest.approx(mu_y / abs(act_y) * fy0, rel=1e-9)


@pytest.mark.long
def test_the_belt_of_a_tyre_whose_deflection_grows_turns_it():
    """M = QTZ1 LGYR MBELT Re Omega dy/dt, where dy/dt = Vy at zero deflection."""
    lengths = {**PLAIN, "PTX1": 1.0, "PTY1": 1.0, "PTY2": 1.8}
    couples = []
    for belt in (0.0, 0.7):
        tyre = TyreProperties(coefficients=lengths, belt=belt)
        found = reported(wheel(MagicFormulaTyre(i="wheel", properties=tyre), 0.32, 0.02, 0.06, 0.0, 20.0, 64.0))
        couples.append(found["aligning"])
    assert couples[1] - couples[0] == pytest.approx(0.7 * (0.32 - 0.02 / 3) * 64 * 20 * math.tan(0.06), rel=1e-10)


@pytest.mark.skipif(not PUBLISHED.is_dir(), reason="the published tyre is not here")
def test_a_published_tyre():
    """Forces on which two other programs agree to 1e-12."""
    for file in sorted(PUBLISHED.glob("*.json")):
        reference = json.loads(file.read_text())
        tyre = TyreProperties.from_file(PUBLISHED / reference["file"])
        columns = dict(zip(reference["columns"], np.array(reference["rows"]).T, strict=True))
        found = tyre.wrench(*(columns[name] for name in ("Fz", "kappa", "alpha", "gamma")), speed=reference["Vx"])
        for channel, name in (
            ("longitudinal", "Fx"), ("lateral", "Fy"), ("overturning", "Mx"), ("rolling", "My"), ("aligning", "Mz"),
        ):  # fmt: skip
            scale = np.abs(columns[name]).max()
            assert found[channel] == pytest.approx(columns[name], rel=1e-12, abs=1e-12 * scale), name


def test_a_wheel_has_the_forces_of_its_slip():
    """The tyre on a cambered, slipping wheel: slips, load, and the wrench at the wheel's centre from that at the contact."""
    alpha, gamma, d, V = 0.06, 0.03, 0.02, 20.0
    rolling = 0.32 - d / 3
    spin = 1.08 * V / rolling
    found = reported(wheel(MagicFormulaTyre(i="wheel", properties=TYRE), 0.32, d, alpha, gamma, V, spin))
    assert found["load"] == pytest.approx(2e5 * d, rel=1e-12)
    assert found["slip"] == pytest.approx(0.08, rel=1e-11)
    assert (found["slip_angle"], found["camber"]) == pytest.approx((alpha, gamma), rel=1e-12)
    expected = TYRE.wrench(2e5 * d, 0.08, alpha, gamma, speed=V)
    for name, value in expected.items():
        assert found[name] == pytest.approx(float(value), rel=1e-10, abs=1e-9), name
    fx, fy, n = found["longitudinal"], found["lateral"], found["load"]
    assert (found["fx"], found["fy"], found["fz"]) == pytest.approx((fx, fy, n), rel=1e-12)
    arm = np.array([0, (0.32 - d) * math.sin(gamma), -(0.32 - d) * math.cos(gamma)])
    at_contact = np.array([found[name] for name in ("overturning", "rolling", "aligning")])
    torque = np.cross(arm, (fx, fy, n)) + at_contact
    assert (found["tx"], found["ty"], found["tz"]) == pytest.approx(torque, rel=1e-11, abs=1e-9)


def test_the_tyre_of_the_other_side_is_its_mirror_image():
    file = TyreProperties(coefficients={**PLAIN, "PHY1": 0.004, "PVY1": 0.03, "QDZ6": 0.01})
    left = reported(wheel(MagicFormulaTyre(i="wheel", properties=file), 0.32, 0.02, 0.05, 0.02, 15.0, 50.0))
    right = reported(wheel(MagicFormulaTyre(i="wheel", properties=file, hand=-1), 0.32, 0.02, -0.05, -0.02, 15.0, 50.0))
    for name in ("longitudinal", "load", "rolling"):
        assert left[name] == pytest.approx(right[name], rel=1e-12)
    for name in ("lateral", "overturning", "aligning", "slip_angle"):
        assert left[name] == pytest.approx(-right[name], rel=1e-12, abs=1e-9)


def test_a_braked_wheel_comes_to_rest_without_chatter():
    """From 20 m/s to a standstill: the wheel stays where it stopped, and the steps don't pile up."""
    model = Model("braked", gravity=(0, 0, -9.81))
    position, spin = (0, 0, 0.32 - 400 * 9.81 / 2e5), 20 / (0.32 - 400 * 9.81 / 6e5)
    model.add("wheel", Body(mass=400, inertia=(20, 30, 20), position=position, velocity=(20, 0, 0), omega=(0, spin, 0)))
    model.add("tyre", MagicFormulaTyre(i="wheel", properties=TyreProperties(coefficients=PLAIN)))
    brake = "-900*tanh(20*wheel.wy)"
    model.add("brake", AppliedTorque(i="wheel", axes="body", torque=(0, brake, 0)))
    solution = model.run(duration=6.0)
    assert solution.success
    assert abs(solution["wheel.vx"][-1]) < 1e-3
    assert solution["wheel.x"].max() - solution["wheel.x"][-1] < 0.05
    assert solution.solver["steps"] < 3000
