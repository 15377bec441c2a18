"""Decisions of error bars, of reruns, of the search for missed events, and of dense or sparse matrices."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from stiffmbs import tuning
from stiffmbs.model.settings import RunSettings
from stiffmbs.redundancy.sparse_matrix import SparseMatrix
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Outcome
from stiffmbs.verification import diagnostics, missed_events, verify
from stiffmbs.verification.diagnostics import Comparison, divergence
from stiffmbs.verification.missed_events import Along
from stiffmbs.verification.solve_again import Deadline, OutOfTime, shorter_step, tolerances
from tests.decisions.common import Reached, Record, nothing, parameters
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while

SETTINGS = RunSettings(duration=1.0)


class Results(Record):
    """Results of a run with a number of channels."""

    def __len__(self):
        return self.channels

    def __iter__(self):
        return iter(())


def asked(call):
    """Return what a replaced function raises."""
    try:
        call()
    except Reached as found:
        return found.args[0]
    raise AssertionError


def raising(place):
    """Return a function that raises one of its arguments."""

    def raised(*arguments, **_):
        raise Reached(arguments[place])

    return raised


def peaks(excess):
    values = {"a": np.array([0.0, excess, 0.0])}
    return missed_events._peaks(values, ["a"], np.ones(3, dtype=bool), np.array([0, 2]), {"a": 1.0})


def instants(order=(), channels=1):
    """Return the number of times at which an interval is sampled."""
    first = Results(
        time=np.arange(2.0), step_times=np.arange(2.0), history=Record(order=order), channels=channels
    )  # fmt: skip
    features = Record(instants=lambda *_: np.empty(0))
    return len(missed_events.more_instants(first, features))


def samples(products):
    """Return the samples of a run whose poses took a number of multiplications."""
    solution = Results(time=np.arange(3.0), channels=0)
    run = Record(solution=solution, obstacle="", at=np.array([0, 2]))
    replaced = {
        "poses_of": lambda *_: Record(products=products, at_singular=lambda _: slice(0, 0)), "_peaks": lambda *_: {1},
    }  # fmt: skip
    with patch.multiple(missed_events, **replaced):
        return missed_events.dense_samples(None, run, {})


def acceptable(rtol):
    return Comparison.acceptable.fget(Record(job=Record(settings=RunSettings(duration=1.0, rtol=rtol))))


def converges(ratio):
    """Return whether peaks converge whose differences decrease by a ratio."""
    tighter = [Record(obstacle="", reported=lambda _, peak=peak: np.array([0.0, peak])) for peak in (ratio, ratio + 1)]
    comparison = Record(
        job=Record(settings=SETTINGS), first={"a": np.zeros(2)}, tighter=tighter, uncertain={"a": 10.0}, acceptable=1.0
    )
    return "they converge" in diagnostics._remedy(comparison, "a", False)


def named_channels():
    comparison = Record(uncertain=dict.fromkeys("abcdefghijkl", 1.0))
    with patch.multiple(diagnostics, _peak=lambda *_: "peak", _remedy=lambda *_: ""):
        return diagnostics._uncertain_note(comparison, False).split(";")[0].count("peak") - 1


def is_chaotic(delay):
    """Return whether a motion is sensitive, whose divergence a tighter tolerance delays by a factor."""
    found = [Record(t=t, body="a", begun=0.0) for t in (1.0, delay)]
    runs = [Record(name="b"), Record(name="c")]
    comparison = Record(
        between=None, first=None, other=None, tighter=runs, job=Record(settings=SETTINGS, grid=Record(start=0.0))
    )  # fmt: skip
    with patch.object(diagnostics, "poses_of", lambda *_: Record(nearest=nothing_near)):
        return "chaotic" in diagnostics._divergence_note(comparison, found, found[0])


def nothing_near(*_):
    return None


def shortest(steps):
    """Return the ratio of the duration of a run to the longest step of its rerun."""
    times = np.linspace(0.0, 1.0, steps + 1)
    return 1.0 / shorter_step(Record(step_times=times, time=times))


def stopped_at():
    """Return the part of the allowed effort, in percent, at which a run without progress is stopped."""

    def goes_on(percent):
        effort = iter([0.0, 0.01 * percent])
        try:
            Deadline(0.0, 1.0, 1.0, lambda: next(effort))(0.0)
        except OutOfTime:
            return False
        return True

    return count_while(goes_on, range(1, 100))


def job(**system):
    counts = iter(range(100))
    return Record(
        evaluations=lambda: next(counts), dynamics=Record(system=Record(**system), report=nothing),
        start=Record(q=np.zeros(1), u=np.zeros(1)), settings=RunSettings(duration=1.0, rtol=1e-6),
        grid=Record(start=0.0, end=1.0),
    )  # fmt: skip


def sampled():
    first = Record(time=np.arange(2.0), step_times=np.arange(2.0))
    return len(missed_events._instants(job(), first, 1e9))


def effort_of_samples():
    with patch.object(missed_events, "_instants", raising(2)):
        return asked(lambda: missed_events.looked_along(job(), None, 1.0))


def same_motion(off):
    first = {"energy.kinetic": np.array([1.0, 1.0])}
    with_time = type("First", (dict,), {"time": np.arange(2.0)})(first)
    return missed_events._same_motion(with_time, np.arange(2.0), np.array([1.0, 1.0 + off]))


def effort(evaluations):
    """Return the evaluations that all reruns of a run may take."""
    of_run = Record(
        settings=Record(tuning={"verification": tuning.numbers_of(parameters("verification"))}, accuracy=None), evaluations=lambda: evaluations, dynamics=Record(system=Record(n_q=1, n_u=1, n_c=0))
    )  # fmt: skip
    replaced = {
        "data_of": nothing, "with_elements": nothing, "prepare": lambda *_, **__: of_run,
        "solved": lambda *_: Record(time=np.arange(2.0), outcome=None), "verified": raising(2),
    }  # fmt: skip
    with patch.multiple(verify, **replaced):
        return asked(lambda: verify.verify(None))


def tolerance_of_the_other():
    own = Record(
        _job=Record(settings=SETTINGS), _first=None, _traits=Record(fixed_steps=True), _left=nothing, _again=raising(1)
    )
    with patch.object(verify, "other_integrators", lambda *_: [{}]):
        return asked(lambda: verify._Verification._ask_the_other(own))["rtol"]


def tightened():
    """Return the number of tolerances, in quarter octaves of 1e-14, that are tightened by less than a power of ten."""

    def is_looser(rtol):
        return tolerances(Record(rtol=1e-14 * rtol, atol=None), 1)["rtol"] > 1e-14 * rtol

    return count_while(is_looser, DOUBLES)


def least_size_of_a_rate():
    """Return the size of the rate of a state of 2 that is constant for 4 s."""
    channels = {"a.x": np.full(2, 2.0), "a.x.rate": np.full(2, 1e-9)}
    first = Solution("", np.array([0.0, 4.0]), channels, Outcome.DONE, "", (), {}, None, None)
    system = Record(size=1.0, states=("a.x",))
    return verify._sizes(Record(data=Record(gravity=(0.0, 0.0)), dynamics=Record(system=system)), first)["a.x.rate"]


def begin_of_a_divergence():
    times = np.arange(200.0)
    return divergence(times, {"a": 1e-9 * DOUBLES[:200]}).begun


DECISIONS = {
    "verification.blown_up": lambda: count_while(lambda excess: peaks(excess), HALVES),
    "verification.parts_of_implicit_steps": lambda: instants(order=(1,)),
    "verification.parts": instants,
    "verification.most_values": lambda: count_while(lambda count: instants(channels=int(count)) > 2, DOUBLES),
    "verification.most_products": lambda: count_while(lambda products: samples(products), DOUBLES),
    "verification.amplified": lambda: acceptable(1e-10),
    "verification.visible": lambda: acceptable(1e-6),
    "verification.loose": lambda: acceptable(1e-2),
    "verification.of_state": least_size_of_a_rate,
    "verification.converges": lambda: count_while(lambda ratio: not converges(ratio), 1.05 ** np.arange(1, 100)),
    "verification.named": named_channels,
    "verification.diverged": lambda: count_while(
        lambda off: divergence(np.zeros(1), {"a": np.array([off])}) is not None, HALVES
    ),
    "verification.together": begin_of_a_divergence,
    "verification.sensitive": lambda: count_while(is_chaotic, 1.05 ** np.arange(100)),
    "verification.tightest_rtol": lambda: tolerances(Record(rtol=1e-12, atol=None), 2)["rtol"],
    "verification.clearly_tighter": tightened,
    "verification.more_steps": lambda: shortest(10_000),
    "verification.least_steps": lambda: shortest(10),
    "verification.looks_ahead": stopped_at,
    "verification.samples": sampled,
    "verification.of_effort_left": effort_of_samples,
    "verification.elsewhere": lambda: count_while(lambda off: not same_motion(off), HALVES),
    "verification.fewest_steps": lambda: Along(Record(shortest=1.0)).max_step,
    "verification.most_effort": lambda: effort(10**9),
    "verification.effort_allowed": lambda: effort(1),
    "verification.other_of_fixed": tolerance_of_the_other,
    "matrices.dense_up_to": lambda: count_while(
        lambda n: SparseMatrix(np.empty(0), np.empty(0), np.empty(0), (n, n)).is_small, range(2000)
    ),
}
EXPECTED = {
    "verification.blown_up": 18, "verification.parts_of_implicit_steps": 3, "verification.parts": 5,
    "verification.most_values": 88, "verification.most_products": 126, "verification.amplified": 0.0001,
    "verification.visible": 0.01, "verification.loose": 1, "verification.of_state": 5e-4, "verification.converges": 14, "verification.named": 3,
    "verification.diverged": 18, "verification.together": 62, "verification.sensitive": 15,
    "verification.tightest_rtol": 1e-13, "verification.clearly_tighter": 18, "verification.more_steps": 40000,
    "verification.least_steps": 1000, "verification.looks_ahead": 30, "verification.samples": 20000,
    "verification.of_effort_left": 0.25, "verification.elsewhere": 27,
    "verification.fewest_steps": 0.2, "verification.most_effort": 10000000000,
    "verification.effort_allowed": 12500000, "verification.other_of_fixed": 1e-10, "matrices.dense_up_to": 401,
}  # fmt: skip
