"""Fiala's tyre against its published formulas, for small and large slips on both sides, forwards and in reverse."""

import math

import pytest

from stiffmbs.spatial import FialaTyre

from .wheels import reported, wheel

R, STIFFNESS, ALONG, ACROSS, STATIC, SLIDING, WIDTH, RESISTANCE = 0.3, 2e5, 6e4, 4.5e4, 1.1, 0.8, 0.2, 0.006
TYRE = FialaTyre(
    i="wheel", radius=R, stiffness=STIFFNESS, slip_stiffness=ALONG, cornering_stiffness=ACROSS,
    mu_static=STATIC, mu_sliding=SLIDING, width=WIDTH, rolling_resistance=RESISTANCE,
)  # fmt: skip


def published(load, kappa, alpha):
    """Return Fx, Fy and Mz of MSC Adams/Tire's Fiala model."""
    whole = min(1.0, math.hypot(kappa, math.tan(alpha)))
    mu = STATIC + (SLIDING - STATIC) * whole
    critical = abs(mu * load / (2 * ALONG))
    fx = ALONG * kappa
    if abs(kappa) > critical:
        fx = math.copysign(mu * load - (mu * load) ** 2 / (4 * ALONG * abs(kappa)), kappa)
    H = 1 - ACROSS * abs(math.tan(alpha)) / (3 * mu * load)
    sign = math.copysign(1.0, alpha) if alpha else 0.0
    if H <= 0:
        return fx, -mu * load * sign, 0.0
    return fx, -mu * load * (1 - H**3) * sign, mu * load * WIDTH * (1 - H) * H**3 * sign


@pytest.mark.parametrize("kappa", [0.0, 0.01, -0.02, 0.3, -0.6])
@pytest.mark.parametrize("alpha", [0.0, 0.02, -0.05, 0.2, -0.4])
def test_forces_and_the_aligning_torque(kappa, alpha):
    deflection, speed = 0.02, 20.0
    load = STIFFNESS * deflection
    spin = (1 + kappa) * speed / (R - deflection / 3)
    found = reported(wheel(TYRE, R, deflection=deflection, slip_angle=alpha, speed=speed, spin=spin))
    assert found["slip"] == pytest.approx(kappa, abs=1e-9)
    assert found["slip_angle"] == pytest.approx(alpha, abs=1e-12)
    fx, fy, mz = published(load, found["slip"], found["slip_angle"])
    assert found["load"] == pytest.approx(load, rel=1e-9)
    assert found["longitudinal"] == pytest.approx(fx, rel=1e-9, abs=1e-6)
    assert found["lateral"] == pytest.approx(fy, rel=1e-9, abs=1e-6)
    assert found["aligning"] == pytest.approx(mz, rel=1e-9, abs=1e-6)
    assert found["rolling"] == pytest.approx(-RESISTANCE * load, rel=1e-9)
