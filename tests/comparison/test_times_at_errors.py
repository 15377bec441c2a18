"""Times at equal errors, crossings and conclusions, of solvers whose times are known."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.comparison import sweep
from stiffmbs.comparison.at_error import AtError, Row, decades, times_at, value_at_error
from stiffmbs.comparison.compare import Comparison
from stiffmbs.comparison.comparison_over import crossings
from stiffmbs.comparison.plan import entries_of
from stiffmbs.model.settings import RunSettings

RTOLS = 10.0 ** -np.arange(3, 8.1, 0.5)
ENTRIES = entries_of(["bdf", "dop853", "auto"], (), RunSettings())


def rows(name, factor=1.0, power=-0.2, error=1.0):
    """Errors in proportion to the tolerance, times by a power of the error."""
    return [
        Row(name, f"rtol {rtol:g}", {"positions": error * rtol}, factor * (error * rtol) ** power, int(1e3 * factor))
        for rtol in RTOLS
    ]


def test_times_are_read_between_the_points():
    found = list(times_at([*rows("bdf", 2.0), *rows("dop853", 1.0, -0.125)], "positions", 1e-12, [1e-4, 1e-6]))
    for at in found:
        assert at.seconds["bdf"] == pytest.approx(2 * at.error**-0.2)
        assert at.seconds["dop853"] == pytest.approx(at.error**-0.125)
        assert at.steps["bdf"] == pytest.approx(2000)
        assert at.fastest == "dop853"
        assert not at.better


def test_a_solver_that_is_always_more_accurate_has_its_fastest_time():
    (at,) = times_at([*rows("bdf"), *rows("dop853", error=1e-6)], "positions", 1e-16, [1e-5])
    assert at.better == ("dop853",)
    assert at.seconds["dop853"] == pytest.approx(min(row.seconds for row in rows("dop853", error=1e-6)))


def test_a_solver_that_is_never_accurate_enough_has_no_time():
    (at,) = times_at([*rows("bdf"), *rows("dop853", error=1e4)], "positions", 1e-12, [1e-5])
    assert set(at.seconds) == {"bdf"}


def test_errors_below_what_the_reference_resolves_are_not_read():
    found = list(times_at(rows("bdf"), "positions", 1e-5, [1e-4, 1e-7]))
    assert [at.error for at in found] == [1e-4]


def test_failed_and_diverged_rows_count_for_nothing():
    bad = [Row("bdf", "rtol 0.1", {}, np.nan, 0, "stopped"), Row("bdf", "rtol 0.01", {"positions": np.inf}, 1.0, 5)]
    (at,) = times_at([*bad, *rows("bdf")], "positions", 1e-12, [1e-5])
    assert at.seconds["bdf"] == pytest.approx(1e-5**-0.2)


def test_decades_are_those_of_the_errors():
    assert decades(rows("bdf"), "positions", 1e-12) == pytest.approx([10.0**-k for k in range(3, 9)])
    assert decades(rows("bdf"), "positions", 3e-6) == pytest.approx([1e-3, 1e-4, 1e-5])
    assert decades(rows("bdf"), "positions", 0.05) == pytest.approx([0.1])
    assert decades([], "positions", 1e-12) == []
    at_rest = [Row("bdf", "rtol 0.1", {"positions": 0.0}, 1.0, 5)]
    assert decades(at_rest, "positions", 0.0) == []


def compared(*measured):
    """A comparison of rows alone."""
    at_errors = tuple(times_at(measured, "positions", 1e-12, [1e-4, 1e-5, 1e-6]))
    return Comparison("", "positions", measured, at_errors, None, ENTRIES, False)


def test_the_conclusion_names_the_fastest_and_its_lead():
    told = compared(*rows("bdf"), *rows("dop853", 0.5), *rows("auto", 0.6)).conclusion
    assert told == (
        "at an error of 1e-04 to 1e-06 m or rad dop853 is the fastest, 2 times as fast as bdf; auto takes 1.2 times as long as the "
        "fastest"
    )
    assert "bdf and dop853 are equally fast" in compared(*rows("bdf"), *rows("dop853", 0.95)).conclusion
    assert "only bdf has a time" in compared(*rows("bdf"), *rows("dop853", error=1e4)).conclusion


def test_the_conclusion_changes_with_the_error():
    """Times that cross at 1e-5: one goes by the power -0.2, the other by -0.1."""
    told = compared(*rows("bdf", 1e-5**0.1), *rows("dop853", 1.0, -0.1)).conclusion
    assert told.startswith(
        "at an error of 1e-04 m or rad bdf is the fastest, 1.3 times as fast as dop853; at an error of 1e-05"
    )
    assert "1e-06 m or rad dop853 is the fastest" in told


def at_each(values, bdf, dop853):
    return [
        AtError(1e-4, {name: f(v) for name, f in (("bdf", bdf), ("dop853", dop853)) if np.isfinite(f(v))}, {}, ())
        for v in values
    ]


def test_the_crossing_is_where_both_take_as_long():
    """Explicit steps in proportion to the root of a stiffness, implicit ones to its twelfth root: alike at 1e6."""
    values = [1e4, 1e5, 1e7, 1e8]
    times = at_each(values, lambda k: 10 * k ** (1 / 12), lambda k: 10 * 1e6 ** (1 / 12 - 1 / 2) * k**0.5)
    (found,) = crossings(values, times, ENTRIES)
    assert found.at == pytest.approx(1e6)
    assert (found.before, found.then, found.between, found.measured) == ("dop853", "bdf", (1e5, 1e7), True)


def test_along_less_than_a_decade_the_crossing_lies_on_a_straight_line():
    """Where the ratio of times is exp(v - 2.3)."""
    values = [1.0, 2.0, 3.0, 4.0]
    (found,) = crossings(values, at_each(values, lambda v: 1.0, lambda v: np.exp(v - 2.3)), ENTRIES)
    assert found.at == pytest.approx(2.3)


def test_a_solver_that_fails_from_somewhere_on_is_crossed_in_between():
    values = [1e5, 1e6, 1e7]
    (found,) = crossings(values, at_each(values, lambda k: 2.0, lambda k: 1.0 if k < 5e6 else np.inf), ENTRIES)
    assert (found.before, found.then, found.between, found.measured) == ("dop853", "bdf", (1e6, 1e7), False)


def test_values_without_any_time_are_passed_over():
    values = [1e5, 1e6, 1e7]
    times = at_each(values, lambda k: 1.0, lambda k: k / 1e6)
    times[1] = None
    (found,) = crossings(values, times, ENTRIES)
    assert found.between == (1e5, 1e7)
    assert found.at == pytest.approx(1e6)


def test_one_kind_of_solver_crosses_nothing():
    values = [1e5, 1e7]
    assert not list(crossings(values, at_each(values, lambda k: 1.0, lambda k: k), ENTRIES[:1]))


def test_a_line_goes_through_the_points_within_a_decade_and_a_half():
    """Four points within 31.6 times the target error determine it, those beyond do not; of three, the neighbours do."""
    ratios = np.array([1 / 40, 1 / 20, 1 / 2, 2, 20, 40])
    values = np.array([50.0, 3.0, 2.0, 1.1, 0.4, 0.01])
    points = list(zip(1e-5 * ratios, values, strict=True))
    through = np.exp(np.polyfit(np.log(ratios[1:5]), np.log(values[1:5]), 1)[-1])
    assert value_at_error(points, 1e-5) == pytest.approx(through)
    assert value_at_error(points[2:], 1e-5) == pytest.approx(np.sqrt(2.0 * 1.1))
    steep = [(1e-5 * ratio, 1 / ratio) for ratio in (0.5, 2)]
    assert value_at_error([*steep, (2e-4, 1e-6)], 1e-5) == pytest.approx(1.0)


def test_a_line_through_points_on_one_side_of_the_error_is_not_extended_to_it():
    """The only smaller error is beyond the window: the line runs between the neighbours of the target."""
    points = [(1e-5 * ratio, 1 / ratio) for ratio in (1 / 40, 2.5, 5, 10, 20)]
    assert value_at_error(points, 1e-5) == pytest.approx(1.0)
    assert value_at_error(points[1:], 1e-5) is None


@pytest.mark.parametrize(("seconds", "again"), [(0.15, True), (0.25, False)])
def test_a_solution_of_a_fifth_of_a_second_is_timed_once(examples, monkeypatch, seconds, again):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    monkeypatch.setattr(sweep, "seconds_of", lambda solve: (seconds, solve()))
    monkeypatch.setattr(sweep.Sweep, "_errors", lambda *_: {"positions": 1e-6})
    measured = sweep.Sweep(scene, scene.run, None, 100.0, lambda line: None).points(ENTRIES[0], [1e-4])
    assert (next(measured).solve is not None) == again
