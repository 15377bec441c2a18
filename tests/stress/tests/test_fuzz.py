"""A fuzzer's hangs, crashes and wrong answers are found, and the trials after them run."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from tests.stress import child, fuzz
from tests.stress.__main__ import stress as command
from tests.stress.case import Outcome
from tests.stress.fuzzers import constraints, entry_points

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

TOY = "tests.stress.tests.toy_fuzzer"


def stress(*arguments):
    return CliRunner().invoke(command, [*arguments])


@pytest.fixture
def toy(monkeypatch):
    monkeypatch.setattr(fuzz, "fuzzers", lambda: {"toy": TOY})


def test_hangs_crashes_and_wrong_answers_are_found():
    found = {trial.seed: trial.verdict for trial in fuzz.trials(TOY, range(8), time_limit=0.3)}
    assert [found[seed].outcome.value for seed in range(8)] == ["right", *(5 * ["WRONG"]), "told", "right"]
    assert found[1].detail == "no end within 0.3 s"
    assert found[2].detail == "the process ended by SIGSEGV"
    assert found[3].detail == "the process ended with exit status 7"
    assert found[4].detail == "ZeroDivisionError: a step of zero"
    assert found[5].error == 2.0


def test_a_trial_may_wait_for_the_processor_but_not_for_ever(monkeypatch):
    """A trial is judged by its processor time; one that sleeps is given up later, by the clock."""
    monkeypatch.setattr(child, "WAITING", 2.0)
    waiting, asleep = fuzz.trials(TOY, (8, 9), time_limit=0.3)
    assert waiting.verdict.outcome is Outcome.RIGHT
    assert asleep.verdict.detail == "no end within 0.3 s"


def test_a_module_that_cannot_be_imported_is_wrong():
    (trial,) = fuzz.trials("tests.no_such_fuzzer", [0])
    assert trial.verdict.outcome is Outcome.WRONG


def test_the_command_prints_what_is_wrong_and_counts(toy):
    result = stress("--fuzz", "toy", "--seed", "4", "--count", "4")
    assert result.exit_code == 1
    assert result.output.splitlines() == [
        "WRONG  seed 4: ZeroDivisionError: a step of zero",
        "WRONG  seed 5: 2.0e+00 of 1e+00  another mass",
        "4 trials: 1 right, 1 told, 2 WRONG",
    ]
    result = stress("--fuzz", "toy", "--seed", "6", "--count", "2", "--json")
    assert result.exit_code == 0
    rows = [json.loads(line) for line in result.output.splitlines()]
    assert [(row["seed"], row["outcome"], row["error"]) for row in rows] == [(6, "told", None), (7, "right", 0.5)]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--fuzz"], "found the fuzzer '', expected one of these: toy (nothing but failures)"),
        (["--fuzz", "fuzzy"], "found the fuzzer 'fuzzy', expected one of these: toy (nothing but failures)"),
        (["--fuzz", "toy", "--quick"], "found CASE or --quick beside --fuzz, expected one or the other"),
        (["--count", "3"], "found --count or --seed, expected them with --fuzz alone"),
    ],
)
def test_what_does_not_fit_is_refused(toy, arguments, sentence):
    result = stress(*arguments)
    assert result.exit_code == 2
    assert result.output == f"stress: {sentence}\n"


def test_every_fuzzer_says_what_it_tries():
    assert all(fuzz.module_of(name) for name in fuzz.fuzzers())
    assert stress("--fuzz").exit_code == 2


@pytest.mark.parametrize("seed", [430003, 450727])
def test_constraints_that_hold_by_a_slope_alone(seed):
    """Slopes of 5e-5 and 1.4e-12: relaxed constraints lost energy without a word there, or took 14 million steps."""
    verdict = constraints.trial(seed)
    assert verdict.outcome is Outcome.RIGHT


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("seed", "kind"), [(0, "urdf"), (2, "urdf"), (8, "mjcf"), (202, "scene")])
def test_conversions_are_compared_and_the_comparison_can_fail(monkeypatch, seed, kind):
    """A robot's or dataset's gravity that is read wrongly is seen."""
    from tests.stress.fuzzers import convert

    trial = convert._converted if kind == "scene" else lambda rng: convert._robot(rng, kind)
    assert trial(np.random.default_rng(seed)).outcome is Outcome.RIGHT
    weaker = [("gravity", "[0.3, 0.2, -5]")]
    load, read = convert.load_robot, convert.read_adams
    monkeypatch.setattr(convert, "load_robot", lambda path, changes=(), **how: load(path, [*changes, *weaker], **how))
    monkeypatch.setattr(convert, "read_adams", lambda text: read(text, weaker))
    assert trial(np.random.default_rng(seed)).outcome is Outcome.WRONG


def test_an_error_of_the_small_masses_between_joints_is_right(monkeypatch):
    """It is proportional to these masses; an error of gravity stays."""
    from tests.stress.fuzzers import convert

    seed, load = 6000014, convert.load_robot
    assert convert.trial(seed).outcome is Outcome.RIGHT
    stronger = [("gravity", "[5.36618, 5.77999, -4.0844]")]
    monkeypatch.setattr(convert, "load_robot", lambda path, changes=(), **how: load(path, [*changes, *stronger], **how))
    assert convert.trial(seed).outcome is Outcome.WRONG


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("seed", [6000025, 6000032, 6000033, 6000042, 6000129, 6000133, 6002027])
def test_inputs_do_not_stop_runs(seed):
    """Breakpoints to 1e-11 s, short pulses, branches that are equal up to rounding, and an overflow of cosh stopped runs."""
    from tests.stress.fuzzers import inputs

    assert inputs.trial(seed).outcome is Outcome.RIGHT


@pytest.mark.long(40)
def test_an_error_of_fixed_steps_is_right_if_half_the_step_reduces_it_by_the_order(monkeypatch):
    """A decay of 1600/s has an error of 4 % in steps of 1e-4 s by Euler and Cromer."""
    from tests.stress.fuzzers.discontinuities import kinks

    truth, known = kinks.Chain.truth, []

    def computed_once(chain, times):
        known[:] = known or [truth(chain, times)]
        return known[0]

    monkeypatch.setattr(kinks.Chain, "truth", computed_once)
    assert kinks.trial(6000072).outcome is Outcome.RIGHT
    monkeypatch.setitem(kinks.OF_HALF_STEPS, "euler_cromer", 0.4)
    assert kinks.trial(6000072).outcome is Outcome.WRONG


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", sorted(set(fuzz.fuzzers()) - {"entry-points"}))
def test_the_first_cases_of_a_fuzzer_are_not_wrong(name):
    found = [
        trial.line() for trial in fuzz.trials(fuzz.module_of(name), range(1)) if trial.verdict.outcome is Outcome.WRONG
    ]
    assert not found


def test_the_entry_points_are_fuzzers():
    assert set(entry_points.PAIRS) <= set(fuzz.fuzzers())
