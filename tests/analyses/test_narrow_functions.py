"""Narrow features of Python functions: a repeated run resolves them, or says that it does not."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import Body, Model, PythonForce

TIMES = np.linspace(0, 1, 51)


def law(x, width, centre):
    """A spring of 100 N/m and a Gaussian that changes the speed by about a fifth."""
    return -100 * x + 10 / width * math.exp(-min(((x - centre) / width) ** 2, 700))


def oscillator(width, centre):
    """1 kg released at 1 m, which passes the Gaussian at 10 m/s."""
    model = Model(gravity=(0, 0))
    model.add("b", Body(mass=1, inertia=1, position=(1, 0)))
    model.add("f", PythonForce(i="b", of=("b.x",), function=lambda x: (law(x[0], width, centre), 0, 0)))
    return model


def exact(width, centre):
    return solve_ivp(
        lambda t, y: [y[1], law(y[0], width, centre)], (0, 1), [1, 0], "DOP853", TIMES, rtol=1e-9, atol=1e-9,
        max_step=width / 10,
    ).y[0]  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize(
    "solver",
    ["bdf", *(pytest.param(name, marks=(pytest.mark.long, pytest.mark.sampled(2))) for name in ("radau", "projected"))],
)
def test_a_repeated_run_is_right(solver):
    """bdf missed later passages in the repeated run: errors of 0.3 m."""
    found = stiffmbs.run(oscillator(0.01, 0.3), duration=1.0, points=51, rtol=1e-4, solver=solver)
    np.testing.assert_allclose(found["b.x"], exact(0.01, 0.3), rtol=0, atol=1e-3, err_msg=str(found.notes))


@pytest.mark.long
def test_features_too_narrow_to_be_resolved_are_reported():
    """Some 200 000 steps would resolve it, and the run says that its results may be wrong."""
    found = stiffmbs.run(oscillator(1e-4, 0.3), duration=2.0, points=51, rtol=1e-6, solver="bdf")
    assert any("missed 'f'" in note and "may be wrong" in note for note in found.notes)


def test_a_missed_interval_of_constant_force_is_noticed_where_a_sample_is_at_its_edge():
    """A barrier of 15 J stops 1.6 J. A sample of the check is within its errors of the edge, the others are far inside."""
    model = Model(gravity=(0, 0))
    model.add("b", Body(mass=1, inertia=1, position=(1, 0), velocity=(-1.8, 0)))
    barrier = PythonForce(i="b", of=("b.x",), function=lambda x: (3080.0 if abs(x[0] - 0.019) < 0.0025 else 0.0, 0, 0))
    model.add("f", barrier)
    found = stiffmbs.run(model, duration=1.0, points=51, rtol=1e-3, solver="radau")
    assert any("missed 'f'" in note for note in found.notes)
    np.testing.assert_allclose(found["b.vx"][-1], 1.8, rtol=1e-3)
