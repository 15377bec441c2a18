"""No case of stress has a wrong answer, each comes out as it is listed, and the judges can tell."""

import json
from functools import partial

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from tests.stress.__main__ import stress as command
from tests.stress.case import Case, Outcome, measured, told
from tests.stress.catalogue import catalogue, outcomes
from tests.stress.exact_rank import Guide, Pin, rank
from tests.stress.mechanisms.double_pendulum import angles, double_pendulum
from tests.stress.mechanisms.pendulum import swing
from tests.stress.simulation import simulation

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

ALWAYS = 1
"""Cases of each family that are run without being asked for: compiling the kinds of all of them takes minutes."""
COSTLY = ("space", "held_twice", "cars_over_lines")
"""Families whose first case compiles more kinds than others."""
WHOLE = ("changed_files", "opposed_actuators", "own_field_names")
"""Families of which all cases are run without being asked for: no other test has their scenes."""
MANY = (pytest.mark.long, pytest.mark.sampled(37))
"""As many families have each case for each of four solvers, no even number: every solver has its turn."""
QUICK = [
    pytest.param(family, case, marks=MANY if (number >= ALWAYS and family not in WHOLE) or family in COSTLY else ())
    for family, cases in catalogue().items()
    for number, case in enumerate(case for case in cases if case.quick)
]
LONG = [(family, case) for family, cases in catalogue().items() for case in cases if not case.quick]


def _label(value):
    return value if isinstance(value, str) else value.name


@pytest.mark.parametrize(("family", "case"), QUICK, ids=_label)
def test_case(family, case):
    (row,) = outcomes([(family, case)])
    assert row.verdict.outcome is case.expected, row.verdict


@pytest.mark.sampled(123)
@pytest.mark.parametrize(("family", "case"), LONG, ids=_label)
def test_long_case(family, case):
    (row,) = outcomes([(family, case)])
    assert row.verdict.outcome is case.expected, row.verdict


def test_names_are_unique():
    names = [case.name for cases in catalogue().values() for case in cases]
    assert len(set(names)) == len(names)


def stress(*arguments):
    return CliRunner().invoke(command, [*arguments])


def test_the_command_shows_what_came_of_each_case():
    result = stress("mass ratio 1e+03, bdf", "a duration below zero")
    assert result.exit_code == 0
    assert "right  masses: mass ratio 1e+03, bdf" in result.output
    assert "told   backward: a duration below zero" in result.output
    assert result.output.splitlines()[-1] == "2 cases: 1 told, 1 right"
    rows = [json.loads(line) for line in stress("backward", "--quick", "--json").output.splitlines()]
    assert {row["outcome"] for row in rows} == {"right", "told"}
    assert all(row["family"] == "backward" for row in rows)


def test_an_unknown_case_is_refused():
    result = stress("no such case")
    assert result.exit_code == 2
    assert "found the case 'no such case', expected a case or a family: " in result.output


WRONG = {
    "error": lambda: measured(2.0, 1.0),
    "no number": lambda: measured(np.nan, 1.0),
    "silent": lambda: told("it stopped", ("hinge",)),
    "wrong before": lambda: told("hinge: it stopped", ("hinge",), 2.0, 1.0),
    "crash": lambda: 1 / 0,
}


@pytest.mark.parametrize("judge", WRONG.values(), ids=WRONG)
def test_a_wrong_answer_is_called_wrong(judge, monkeypatch):
    case = Case("bad", "", judge)
    (row,) = outcomes([("made up", case)])
    assert row.verdict.outcome is Outcome.WRONG
    monkeypatch.setattr("tests.stress.catalogue.chosen", lambda names, quick: [("made up", case)])
    result = stress()
    assert result.exit_code == 1
    assert "WRONG  made up: bad" in result.output


def test_a_run_that_goes_astray_is_called_wrong():
    """The masses of another pendulum than the one that the judge has in mind."""
    scene = partial(double_pendulum, masses=(1.0, 1.1))
    case = simulation(
        "astray",
        "",
        scene,
        lambda s: np.max(np.abs(s["inner.angle"] - angles(s.t)[:, 0])),
        1e-5,
        duration=1.0,
        points=11,
    )
    (row,) = outcomes([("made up", case)])
    assert row.verdict.outcome is Outcome.WRONG
    assert row.verdict.error > 1e-2


def test_a_run_that_takes_too_long_is_called_slow(monkeypatch):
    monkeypatch.setattr("tests.stress.simulation.PATIENCE", 0.0)
    case = simulation("slow", "", double_pendulum, lambda s: 0.0, 1.0, duration=100.0, points=11)
    (row,) = outcomes([("made up", case)])
    assert row.verdict.outcome is Outcome.SLOW
    assert "aborted" in row.verdict.detail


@pytest.mark.parametrize(
    ("start", "speed"), [(0.5, 0.0), (3.1, 0.0), (-1.0, 2.0), (0.3, -4.0), (0.7, 9.0), (0.7, -9.0)]
)
def test_the_pendulum_in_closed_form(start, speed):
    """phi'' = -w^2 sin(phi), by finite differences, from the given start."""
    t, h = np.linspace(0, 2, 2001), 1e-3
    phi = swing(t, start, 3.0, speed)
    np.testing.assert_allclose(np.diff(phi, 2) / h**2, -9 * np.sin(phi[1:-1]), atol=1e-4)
    assert phi[0] == pytest.approx(start, abs=1e-12)
    assert (phi[1] - phi[0]) / h == pytest.approx(speed, abs=0.02)


def test_the_double_pendulum_keeps_its_energy():
    t = np.linspace(0, 1.5, 16)
    a, b = angles(t).T
    v, w = (np.gradient(angles(np.linspace(0, 1.5, 15001))[:, k], 1e-4)[::1000] for k in (0, 1))
    kinetic = v**2 / 6 + (v**2 + w**2 / 3 + v * w * np.cos(a - b)) / 2
    potential = 9.81 * (1.5 * np.sin(a) + 0.5 * np.sin(b))
    np.testing.assert_allclose(kinetic + potential, 0, atol=1e-3)


def test_the_exact_rank_of_known_mechanisms():
    from fractions import Fraction as F

    square = [Pin(-1, 0, (F(0), F(0))), Pin(0, 1, (F(0), F(1))), Pin(1, 2, (F(1), F(1))), Pin(-1, 2, (F(1), F(0)))]
    centres = [(F(0), F(1, 2)), (F(1, 2), F(1)), (F(1), F(1, 2))]
    assert rank(centres, square) == 8
    third = [*square, Pin(-1, 3, (F(1, 2), F(0))), Pin(1, 3, (F(1, 2), F(1)))]
    assert rank([*centres, (F(1, 2), F(1, 2))], third) == 11  # 12 equations
    guides = [Guide(-1, 0, (F(0), F(y)), (F(3), F(4))) for y in range(3)]
    assert rank([(F(0), F(0))], guides) == 2


def test_a_judge_looks_at_a_solution():
    solution = stiffmbs.run(double_pendulum(), duration=0.1, points=3)
    assert solution.t[-1] == pytest.approx(0.1)
