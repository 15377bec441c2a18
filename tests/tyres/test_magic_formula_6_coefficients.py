"""Every coefficient of the Magic Formula 6.1 and 6.2 against an independent implementation, at random tyres and states."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import Float

from stiffmbs.elements.tyres import magic_formula_6, steady_state
from stiffmbs.elements.tyres.names import COEFFICIENTS_6, SCALES_6, TURN_SLIP
from stiffmbs.spatial import MagicFormulaTyre
from stiffmbs.tyres import TyreProperties

from .plain_magic_formula_6 import plain_wrench_6
from .test_magic_formula_coefficients import SIZES
from .wheels import reported, wheel

TOLERANCE = 1e-10
OF_THE_BODY = {
    "FNOMIN": 4000.0, "UNLOADED_RADIUS": 0.33, "VERTICAL_STIFFNESS": 2e5, "LONGVL": 16.0, "NOMPRES": 2.4e5,
    "LONGITUDINAL_STIFFNESS": 3.5e5, "LATERAL_STIFFNESS": 1.1e5, "WIDTH": 0.2, "ASPECT_RATIO": 0.5, "Q_V1": 7e-4,
    "DREFF": 0.27, "BREFF": 8.0, "FREFF": 0.06, "Q_RE0": 1.0,
}  # fmt: skip
ABOUT = {
    **SIZES, "PKY4": 1.9, "PKY6": -0.9, "QSY7": 0.9, "PHYP1": 1.0, "PHYP2": 0.15, "PHYP4": -4.0, "PECP1": 0.5, "QDTP1": 10.0,
    "QCRP1": 0.2, "QCRP2": 0.1, "QBRP1": 0.1, "QDRP1": 1.0, "PDXP1": 0.4, "PKYP1": 1.0, "PDYP1": 0.4, "QSX6": 1.0, "QSX9": 3.0,
}  # fmt: skip
SHIFTS = (
    "PHX1", "PHX2", "PVX1", "PVX2", "PHY1", "PHY2", "PVY1", "PVY2", "QHZ1", "QHZ2", "QDZ6", "QDZ7", "RHX1", "RHY1", "RHY2", "SSZ1",
)  # fmt: skip
"""Shifts of the curves, which the direction of rolling does not mirror."""
SEEDS = st.integers(0, 2**32 - 1)


@pytest.fixture(autouse=True, scope="module")
def sharp_arccosine():
    """The package rounds the arccosine of 4.104 over 1e-3; the comparison is without."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(magic_formula_6, "ROUNDED", Float("1e-24"))
        steady_state._compiled.cache_clear()
        yield
    steady_state._compiled.cache_clear()


def random_tyre(seed):
    """All coefficients and scale factors, none at a value where it has no effect."""
    rng = np.random.default_rng(seed)
    found = dict(OF_THE_BODY)
    for name in COEFFICIENTS_6:
        small = rng.choice([-1, 1]) * rng.uniform(0.02, 0.2)
        found[name] = ABOUT[name] * rng.uniform(0.8, 1.2) if name in ABOUT else small
    return found | {name: rng.uniform(0.8, 1.2) for name in SCALES_6} | {"LMUV": rng.uniform(0.05, 0.3)}


def random_states(seed, turning, count=20):
    """Camber to 46 deg, walking pace to 40 m/s, forward and backward."""
    rng = np.random.default_rng(seed)
    return {
        "Fz": rng.uniform(500, 9000, count), "kappa": rng.uniform(-0.6, 0.6, count), "alpha": rng.uniform(-0.5, 0.5, count),
        "gamma": rng.uniform(-0.8, 0.8, count), "p": rng.uniform(1.8e5, 3e5, count),
        "Vx": rng.choice([-1, 1], count) * rng.uniform(0.05, 40, count),
        "phit": rng.uniform(-0.8, 0.8, count) if turning else None, "friction": rng.uniform(0.2, 1.1, count),
    }  # fmt: skip


def by_plain(tyre, states, radii):
    rows = []
    for i, radius in enumerate(radii):
        state = {name: None if x is None else float(x[i]) for name, x in states.items()}
        rows.append(plain_wrench_6(tyre, {**state, "mu": state["friction"], "Re": float(radius)}))
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def difference(one, other):
    """The largest difference of any result, as a part of the largest value of its column."""
    return max((np.abs(one[name] - x) / np.abs(x).max()).max() for name, x in other.items())


@pytest.mark.long
@pytest.mark.sampled(6)
@pytest.mark.parametrize("turning", [False, True], ids=["straight", "turn slip"])
@pytest.mark.parametrize("version", ["6.1", "6.2"])
@settings(max_examples=20, deadline=None)
@given(tyre=SEEDS, at=SEEDS)
def test_forces_torques_and_stiffnesses_of_random_tyres(version, turning, tyre, at):
    numbers, states = random_tyre(tyre), random_states(at, turning)
    found = TyreProperties(coefficients=numbers, version=version).steady_state(**states)
    assert difference(found, by_plain(numbers, states, found["Re"])) < TOLERANCE


def test_a_weight_of_combined_slip_below_zero_gives_numbers_with_turn_slip():
    tyre = TyreProperties(coefficients=random_tyre(432141052) | {"RCY1": 1.2, "RBY1": 8.0}, version="6.2")
    found = tyre.steady_state(**random_states(432141052, turning=True, count=200))
    assert all(np.isfinite(x).all() for name, x in found.items() if name not in ("rho", "Rl"))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [*COEFFICIENTS_6, *SCALES_6])
def test_each_coefficient_is_seen(name):
    """The comparison above fails where one coefficient is wrong."""
    turning = name in TURN_SLIP or name == "LMP"
    numbers, states, radii = random_tyre(0), random_states(1, turning, 60), np.full(60, 0.32)
    changed = {**numbers, name: 0.7 * numbers[name]}
    assert difference(by_plain(changed, states, radii), by_plain(numbers, states, radii)) > 1e4 * TOLERANCE


def test_turn_slip_in_reverse_is_the_mirror_image_of_that_forward():
    """The same path driven backward: yaw rate and spin change their signs, the side force does not, the torque does."""
    unshifted = dict.fromkeys(SHIFTS, 0.0)
    tyre = TyreProperties(coefficients=random_tyre(3) | unshifted, version="6.2")
    states = random_states(4, turning=True, count=50) | {"kappa": 0.0}
    states["Vx"] = np.abs(states["Vx"])
    ahead = tyre.steady_state(**states)
    back = tyre.steady_state(**states | {"Vx": -states["Vx"], "phit": -states["phit"]})
    for name, sign in {"Fy": 1, "Mx": 1, "Mzr": -1, "t": -1, "omega": -1, "rho": 1}.items():
        scale = np.abs(ahead[name]).max()
        assert back[name] == pytest.approx(sign * ahead[name], abs=1e-9 * scale), name


@pytest.mark.long
@pytest.mark.sampled(5)
@pytest.mark.parametrize("hand", [1, -1])
@pytest.mark.parametrize("seed", range(3))
def test_a_wheel_has_the_forces_of_its_state_on_either_side_forward_and_backward(seed, hand):
    """The element at slip, camber and speed; a tyre of the other side has the mirrored state."""
    rng = np.random.default_rng(seed)
    numbers = random_tyre(seed) | {
        "Q_V2": 0.04,
        "Q_FZ2": 16.0,
        "Q_FCX": 0.13,
        "Q_FCY": 0.12,
        "PFZ1": 0.7,
        "VERTICAL_DAMPING": 50.0,
    }
    tyre = TyreProperties(coefficients=numbers, version="6.1")
    for speed in (rng.uniform(2, 40), -rng.uniform(2, 40)):
        alpha, gamma = rng.uniform(-0.2, 0.2), rng.uniform(-0.5, 0.5)
        spin = speed / 0.32 * rng.uniform(0.9, 1.1)
        element = MagicFormulaTyre(i="wheel", properties=tyre, pressure=2.5e5, transient=False, hand=hand)
        found = reported(wheel(element, 0.33, 0.02, alpha, gamma, speed, spin))
        state = tyre.steady_state(
            found["load"], found["slip"], hand * found["slip_angle"], hand * found["camber"], p=2.5e5, Vx=speed
        )
        assert found["slip_angle"] == pytest.approx(alpha, abs=1e-12)
        assert state["omega"] == pytest.approx(spin, rel=1e-9)
        names = {"longitudinal": "Fx", "lateral": "Fy", "overturning": "Mx", "rolling": "My", "aligning": "Mz"}
        for channel, column in names.items():
            sign = hand if column in ("Fy", "Mx", "Mz") else 1
            assert found[channel] == pytest.approx(sign * float(state[column]), rel=1e-8, abs=1e-6), (channel, speed)
