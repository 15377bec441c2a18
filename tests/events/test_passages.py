"""bdf after a restart: a window that begins there is not passed over, and errors in windows that repeat do not add up."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.run import prepare


def pushed(law, speed, start, duration, rtol):
    """Return the final velocity of 1 kg under a force on a state that moves at a constant rate."""
    scene = {
        "dimensions": 2, "gravity": [0, 0], "bodies": {"b": {"mass": 1, "inertia": 1}},
        "states": {"p": {"rate": repr(speed), "start": start}},
        "forces": {"f": {"type": "force", "i": "b", "force": [law, 0]}},
    }  # fmt: skip
    model = stiffmbs.read_scene(str(scene))
    return stiffmbs.run(model, solver="bdf", duration=duration, rtol=rtol, points=2)["b.vx"][-1]


@pytest.mark.parametrize("rtol", [1e-2, 1e-4])
@pytest.mark.parametrize("width", [2e-5, 6.963970383758311e-05, 3e-4])
def test_both_halves_of_a_window_push(width, rtol):
    """The forces at the ends of a window are equal, as are those at the ends of a first step over it; a kink comes before."""
    law = f"{2 * 0.48430590480685853 / width}*max(0, 1 - abs(2*((p - 0.3911259341467255)/{width}) - 1)) + 1e-9*abs(p - 0.2)"
    found = pushed(law, 0.48430590480685853, 0.13928404165220387, 1.073929597479124, rtol)
    assert found == pytest.approx(1.0, abs=2e-2 if rtol > 1e-3 else 2e-3)


@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-5])
def test_errors_in_peaks_that_repeat_do_not_add_up(rtol):
    """300 peaks of sin^40, each with an error of a tolerance, would be 6 % off at 1e-4."""
    mean = np.prod((2 * np.arange(20) + 1) / (2 * np.arange(20) + 2))
    assert pushed(f"sin({np.pi * 300}*p)^40/{mean}", 1.0, 0.0, 1.0, rtol) == pytest.approx(1.0, abs=30 * rtol)


def test_steps_resolve_the_zones_of_a_narrow_law():
    """The part of a zone that a step may pass, halved or doubled, gives 13 % more or 11 % fewer steps."""
    scene = {
        "gravity": [0, 0], "bodies": {"b": {"mass": 1, "inertia": 1}}, "states": {"p": {"rate": "1", "start": 0.0}},
        "forces": {"f": {"type": "force", "i": "b", "force": [f"8*sin({np.pi * 300}*p)^40", 0]}},
    }  # fmt: skip
    job = prepare(stiffmbs.read_scene(str(scene)), solver="bdf", duration=1.0, rtol=1e-3, points=2)
    assert job.integrate().statistics["steps"] == pytest.approx(20200, rel=0.08)


def test_a_law_of_a_state_is_not_lost_at_large_arguments():
    """The argument's rounding is longer than that of time: an event at a state must not be met again and again, and then be left out."""
    half = np.arccos(0.99)
    law = f"max(sin(90000*p) - 0.99, 0)*{np.pi / (np.sin(half) - 0.99 * half)}"
    period = 2 * np.pi / (90000 * 0.0157)
    found = pushed(law, 0.0157, 0.25, 100 * period, 1e-3)
    assert found == pytest.approx(100 * period, rel=2e-2)


def test_a_law_that_has_vanished_in_a_negative_power_of_cosh():
    """sinh/cosh^2 is no number beyond 710, where the law is zero."""
    law = "1/cosh(20000*(p - 0.3))*20000/pi"
    assert pushed(law.replace("pi", repr(float(np.pi))), 1.0, 0.0, 0.6, 1e-6) == pytest.approx(1.0, abs=1e-4)
