"""Laws periodic in the state: every period is felt at every tolerance, and what cannot be resolved is reported."""

import numpy as np
import pytest

from stiffmbs import AppliedForce, Body, Model
from stiffmbs.solve.ida.native import ida_events
from tests.decisions.common import Record, always, nothing, searched
from tests.interpreted import interpreted
from tests.stress.case import Outcome
from tests.stress.families.events import periodic_laws
from tests.stress.fuzzers import laws


@pytest.mark.long
@pytest.mark.sampled(44)
@pytest.mark.parametrize("case", periodic_laws.CASES, ids=lambda case: case.name)
def test_each_period_of_a_law_is_felt(case):
    verdict = case.judge()
    assert verdict.outcome is case.expected, verdict


@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-6])
def test_peaks_that_are_as_wide_as_an_explicit_step(rtol):
    """Steps of 2 rad pass such peaks with an error estimate of zero: 1.5 % of the impulse were missing at 1e-6."""
    model = Model()
    model.add("clock", Body(mass=1, inertia=1, position=(0, 1), velocity=(0.933, 0)))
    model.add("pushed", Body(mass=1, inertia=1))
    model.add("wind", AppliedForce(i="clock", force=(0.1175, 0)))
    model.add("push", AppliedForce(i="pushed", force=("0.0424/(1 + (1 - sin(562*clock.vx))/0.1568)", 0)))
    solution = model.run(duration=87.5, points=2, solver="projected", scheme="dopri5", rtol=rtol)
    turn = 562 * (0.933 + 0.1175 * np.linspace(0, 87.5, 2_000_001))
    impulse = np.trapezoid(0.0424 / (1 + (1 - np.sin(turn)) / 0.1568), dx=87.5 / 2_000_000)
    assert abs(solution["pushed.vx"][-1] / impulse - 1) < 1e-4


@pytest.mark.sampled(12)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(20))
def test_random_laws_over_a_state(seed):
    verdict = laws.trial(seed)
    assert verdict.outcome in (Outcome.RIGHT, Outcome.TOLD), verdict


@pytest.mark.long
@pytest.mark.parametrize("seed", [951679, pytest.param(952811, marks=pytest.mark.long)])
def test_a_short_step_before_an_interval_does_not_hide_it(seed):
    """A step of 1e-12 s just before a narrow interval, after hundreds of others: rates over less time are rounding."""
    assert laws.trial(seed).outcome is Outcome.RIGHT


def test_a_motion_that_is_only_extrapolated_has_no_note():
    """Before a step its end is sought along the present accelerations, which differ by orders of magnitude after an impact."""
    w = searched(longest=1e5, n_nodes=0)

    def first_event(*_):
        w.unresolved += 1
        return 0.5

    replaced = {
        "go_ahead": nothing, "take_reactions": nothing, "evaluate_near": lambda *_: np.zeros(1), "note_mean_rates": nothing,
        "suspicious": always, "first_event": first_event,
    }  # fmt: skip
    with interpreted(ida_events, **replaced):
        ida_events._aim(Record(returned=0.0), w, Record(q=None), 1.0)
    assert w.target < 0.5
    assert w.unresolved == 0


@pytest.mark.parametrize("solver", ["bdf", "radau", "projected"])
def test_peaks_of_a_velocity_whose_tolerance_is_a_period(solver):
    """A velocity of 1700 m/s at rtol 1e-3, and a law that repeats every 8.6 m/s: most peaks were passed without an event."""
    model = Model(gravity=(0, 0))
    model.add("clock", Body(mass=1, inertia=1, position=(0, 1), velocity=(1700, 0)))
    model.add("pushed", Body(mass=1, inertia=1))
    model.add("wind", AppliedForce(i="clock", force=(33.5, 0)))
    model.add("push", AppliedForce(i="pushed", force=("step(sin(0.73*clock.vx), 0.9999, 0, 0.99995, 1)", 0)))
    solution = model.run(duration=5, points=2, solver=solver, rtol=1e-3, errors=False)
    turn = 0.73 * (1700 + 33.5 * np.linspace(0, 5, 2_000_001))
    z = np.clip((np.sin(turn) - 0.9999) / 0.00005, 0, 1)
    impulse = np.trapezoid(z * z * (3 - 2 * z), dx=5 / 2_000_000)
    assert solution["pushed.vx"][-1] == pytest.approx(impulse, rel=0.01)


@pytest.mark.parametrize("rtol", [1e-2, 1e-3])
def test_errors_of_bdf_in_equal_peaks_do_not_add_up(rtol):
    """Steps of order 1 on the rising side of each peak had errors of one sign: 5.8 % at 1e-2, 1.8 % at 1e-3."""
    model = Model(gravity=(0, 0))
    model.add("clock", Body(mass=1, inertia=1, position=(0, 1), velocity=(1, 0)))
    model.add("pushed", Body(mass=1, inertia=1))
    model.add("push", AppliedForce(i="pushed", force=("4/(1 + (1 - sin(20*clock.x))/0.00165)", 0)))
    solution = model.run(duration=9, points=2, solver="bdf", rtol=rtol, errors=False)
    impulse = np.trapezoid(4 / (1 + (1 - np.sin(20 * np.linspace(0, 9, 2_000_001))) / 0.00165), dx=9 / 2_000_000)
    assert solution["pushed.vx"][-1] == pytest.approx(impulse, rel=3 * rtol)
