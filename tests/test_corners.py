"""Corners in time: found, stopped at, and so nothing short is jumped over."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Model, Prismatic, SpringDamper, compile_model
from stiffmbs.compile.corners import corner_times
from stiffmbs.describe.table import Table


def sled(force):
    model = Model()
    model.add("sled", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="sled", j="ground"))
    model.add("push", AppliedForce(i="sled", force=(force, 0)))
    return model


PULSE = "100*(step(t, 8, 0, 8.001, 1) - step(t, 8.009, 0, 8.01, 1))"


@pytest.mark.parametrize("at_rest", ["free", "on a spring"])
@pytest.mark.parametrize(
    "how", [{}, {"solver": "projected", "scheme": "dopri5"}, {"solver": "projected", "scheme": "dop853"}], ids=str
)
def test_a_short_pulse_after_a_long_rest_is_seen(at_rest, how):
    """100 N for 9 ms in all on 2 kg at t = 8 s, at a loose tolerance and with no step limit."""
    model = sled(PULSE)
    if at_rest == "on a spring":
        far = stiffmbs.Marker(body="ground", point=(-1, 0))
        model.add("spring", SpringDamper(i="sled", j=far, stiffness=2.0, free_length=1))
    solution = stiffmbs.run(model, duration=10.0, points=11, rtol=1e-4, **how)
    assert np.max(np.abs(solution["sled.x"][:8])) < 1e-12
    gained = 0.9 / 2
    total = solution["energy.kinetic"][-1] + (solution["energy.potential"][-1] if at_rest != "free" else 0)
    assert total == pytest.approx(gained**2, rel=2e-3)
    assert solution.solver["corners"] == 4


def corners(force, start=0.0, end=10.0):
    return corner_times(compile_model(sled(force).data()), start, end)


@pytest.mark.parametrize(
    ("force", "times"),
    [
        (PULSE, [8, 8.001, 8.009, 8.01]),
        ("abs(t - 3)", [3]),
        ("max(0, 2*t - 5)", [2.5]),
        ("sign(sin(t))", [np.pi, 2 * np.pi, 3 * np.pi]),
        ("min(t, 4, 7 - t)", [4, 3.5]),
        ("step(2*t + 1, 3, 0, 5, 1)", [1, 2]),
        ("sin(t)", []),
        ("step(sled.x, 0, 0, 1, 1)", []),
        ("3", []),
        ("step(t, 12, 0, 13, 1)", []),
        ("step(t, 0, 0, 1, 1)", [1]),
    ],
)
def test_where_formulas_have_their_corners(force, times):
    np.testing.assert_allclose(corners(force), sorted(times), atol=1e-12)


def test_an_unmoved_scene_is_not_stopped():
    assert len(corners("1.5")) == 0


def test_corners_before_the_start_and_after_the_end_do_not_count():
    np.testing.assert_allclose(corners("abs(t - 3) + abs(t - 5)", 4, 5), [])


def test_tables_of_time_have_corners_where_flat_parts_end():
    from stiffmbs.compile.corners import _of_table

    pulse = Table(table=((0, 0), (4, 0), (4.1, 1), (4.2, 0), (9, 0), (10, 0)))
    np.testing.assert_allclose(sorted(_of_table(pulse, 0, 10)), [0, 4, 4.2, 10])
    lines = Table(table=((0, 0), (1, 1), (2, 2), (3, 0)), lines=True)
    np.testing.assert_allclose(sorted(_of_table(lines, 0, 10)), [0, 2, 3])


def test_the_result_does_not_depend_on_output_points():
    few = stiffmbs.run(sled(PULSE), duration=10.0, points=2, rtol=1e-8)
    many = stiffmbs.run(sled(PULSE), duration=10.0, points=1001, rtol=1e-8)
    own = stiffmbs.run(sled(PULSE), duration=10.0, points="steps", rtol=1e-8)
    assert len(many.time) == 1001
    for other in (many, own):
        assert other["sled.x"][-1] == pytest.approx(few["sled.x"][-1], abs=1e-7)
        assert np.all(np.diff(other.time) > 0)


def test_an_output_time_may_be_a_rounding_behind_a_corner():
    """0.01 s * 70 is above 0.7 s by one rounding: the row there is that of the corner, and the run goes on."""
    assert 0.01 * 70 > 0.7
    model = sled("step(t, 0.2, 0, 0.7, 4)")
    solution = stiffmbs.run(model, duration=1.0, output=0.01, rtol=1e-8, solver="bdf")
    assert len(solution.t) == 101
    assert solution["sled.vx"][[70, 100]] == pytest.approx([0.5, 1.1], rel=1e-6)  # 4 N / 2 kg, half the ramp's 0.5 s
