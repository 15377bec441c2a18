"""The benchmarks: yardsticks by hand against references, closed values and this package; what the command prints."""

import json
import time

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from tests.bench.__main__ import bench
from tests.bench.benchmark import Row, families
from tests.bench.by_hand import andrews, cart_pendulum, chain, half_car
from tests.bench.by_hand.ida import Run
from tests.bench.contestant import Contestant, Failed
from tests.bench.drives import CARS
from tests.bench.problem import Problem
from tests.bench.problems import andrews as andrews_problem
from tests.bench.problems import cart_pendulum as cart_problem
from tests.bench.problems import chain as chain_problem
from tests.bench.problems import half_car as half_car_problem
from tests.bench.problems.cars.car_conditioning import RTOLS, Conditioning
from tests.bench.report import table
from tests.bench.sweep import at_target_rows

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

FAMILIES = families()
PROBLEMS = {name: family[0] for name, family in FAMILIES.items() if isinstance(family[0], Problem)}
LONG_RACES = ("andrews", "axle_on_bushings", "half_car", "trees_in_space")
BY_HAND = {
    "cart_pendulum": cart_pendulum.si2(),
    "chain": chain.si2(4, 1.0),
    "andrews": andrews.si2(),
    "half_car": half_car.si2(3.0, 0.02),
}


@pytest.mark.parametrize("name", BY_HAND)
def test_jacobians_by_hand_are_the_derivatives_of_the_residuals(name):
    equations, cj, h = BY_HAND[name], 3.7, 1e-6
    run, random = Run(equations, 1e-6), np.random.default_rng(4)
    y, yp = random.normal(size=equations.n), random.normal(size=equations.n)
    columns = [
        (run.residual(0.1, y + d, yp + cj * d) - run.residual(0.1, y - d, yp - cj * d)) / (2 * h)
        for d in h * np.eye(equations.n)
    ]
    expected = np.stack(columns, axis=1)
    np.testing.assert_allclose(run.matrix(0.1, y, yp, cj), expected, atol=1e-9 * np.abs(expected).max(), rtol=1e-6)
    run.close()


@pytest.mark.parametrize("name", BY_HAND)
def test_starts_by_hand_are_consistent(name):
    equations = BY_HAND[name]
    run = Run(equations, 1e-6)
    np.testing.assert_allclose(run.residual(0.0, equations.y, equations.yp), 0, atol=1e-12)
    run.close()


@pytest.mark.sampled(9)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if name in LONG_RACES else ()) for name in PROBLEMS]
)
def test_contestants_agree_with_the_reference(name):
    problem = PROBLEMS[name]
    reference, atol = problem.reference(), BY_ELEMENTS.get(name, 3e-7)
    for contestant in problem.contestants():
        np.testing.assert_allclose(contestant.at(1e-10)(), reference, atol=atol, err_msg=contestant.solver)


def test_references_have_the_published_values():
    cart = PROBLEMS["cart_pendulum"].reference()[-1]
    assert (cart[0], cart[5] + np.pi / 2) == pytest.approx(
        (cart_problem.X_AT_END, cart_problem.THETA_AT_END), abs=1e-11
    )
    for rods, expected in chain_problem.LAST_AT_END.items():
        assert chain_problem.reference(rods, 0.1)[-1, -3:-1] == pytest.approx(expected, abs=2e-11)
    k1, k2, k3, k4, k5, k6, k7 = PROBLEMS["andrews"].reference()[-1, 2::3]
    found = (k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7)
    np.testing.assert_allclose(found, andrews_problem.ANGLES_AT_END, rtol=5e-10)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("k_b", [1e5, *(pytest.param(k_b, marks=pytest.mark.long) for k_b in (1e7, 1e9))])
def test_the_half_cars_references_are_those_of_other_programs(k_b):
    y = half_car_problem.reference(k_b)[:, 1]
    assert (y.max(), y[-1]) == pytest.approx(half_car_problem.CONVERGED[k_b], abs=1e-9)


def test_the_half_car_by_hand_as_an_ordinary_differential_equation():
    from scipy.integrate import solve_ivp

    t, y = 0.0, half_car.minimal_start()
    for stop in (*half_car.CORNERS, 0.5):
        rates = (half_car.minimal, (t, stop), y)
        y = solve_ivp(*rates, method="DOP853", rtol=1e-11, atol=1e-12, args=half_car.numbers_of(1e6, 0.02)).y[:, -1]
        t = stop
    expected = half_car.si2(1e6, 0.02).integrate(1e-11, np.linspace(0, 0.5, 11))[-1]
    np.testing.assert_allclose(y, expected, atol=1e-7)


@pytest.mark.parametrize(
    ("example", "scene"),
    [
        ("cart_pendulum", cart_problem.SCENE),
        ("chain", chain_problem.SCENE.format(rods=10, length=0.1)),
        ("andrews", andrews_problem.SCENE),
        ("half_car", half_car_problem.SCENE.replace("STIFFNESS", "1e7")),
    ],
)
def test_scenes_are_those_of_the_examples(examples, example, scene):
    expected = stiffmbs.run(stiffmbs.load_scene(examples / f"{example}.yaml"), duration=1e-2, points=3, rtol=1e-8)
    found = stiffmbs.run(stiffmbs.read_scene(scene), duration=1e-2, points=3, rtol=1e-8)
    for name in found:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-12, atol=1e-12, err_msg=name)


LONG_LOOKS = (
    "elements_in_space", "chain_scaling", "stiffness", "stepping", "half_car_gradient", "half_car_study", "bushing_fit", "car",
    "car_conditioning", "car_events",
    "car_jobs", "edits", "start_up", "tolerances",
)  # fmt: skip
MANY = (pytest.mark.long, pytest.mark.sampled(5))
BY_ELEMENTS = {"flexible": 2e-6}
"""Errors of discretisation by the finest contestants, m."""
BEYOND_THE_SOLVER = {
    "bushing_fit": 0.1,  # noise of the measured curves
    "reductions": 0.03,  # a coarse mesh, ninth frequency
    "shells": 1.0,  # four elements on each side
    "car_conditioning": 3e-3,  # a car drifts along its road, by 40 to 1000 tolerances from one tolerance to the next
}
WITHOUT_YARDSTICK = (
    "flexible",
    "reductions",
    "shells",
    "tolerances",
    "linear_algebra",
    "bushing_fit",
    "car",
    "car_conditioning",
    "car_events",
    "car_jobs",
    "chain_in_space",
    "elements_in_space",
    "trees_in_space",
    "axle_on_bushings",
    "edits",
)


@pytest.mark.sampled(25)
@pytest.mark.parametrize("name", [pytest.param(name, marks=MANY if name in LONG_LOOKS else ()) for name in FAMILIES])
def test_quick_look_in_json(name):
    result = CliRunner().invoke(bench, ["--quick", "--json", name])
    assert result.exit_code == 0, result.output
    (line,) = result.output.splitlines()
    report = json.loads(line)
    assert report.keys() == {"problem", "machine", "rows"}
    assert report["problem"] == FAMILIES[name][0].name
    for row in report["rows"]:
        assert row.keys() == {"solver", "setting", "error", "seconds", "peer"}
        assert row["error"] < BEYOND_THE_SOLVER.get(name, 1e-3)
        assert row["seconds"] > 0
    assert {row["peer"] for row in report["rows"]} == ({False} if name in WITHOUT_YARDSTICK else {True, False})


@pytest.mark.parametrize(
    "words", [["chain_scaling", "--peers"], ["many_springs", "--solvers"], ["--peers", "--solvers"]]
)
def test_what_cannot_be_measured_is_refused(words):
    result = CliRunner().invoke(bench, [*words])
    assert result.exit_code == 2
    assert "expected one" in result.stderr
    assert not result.stdout


def test_an_unknown_problem_is_refused():
    result = CliRunner().invoke(bench, ["chains"])
    assert result.exit_code == 2
    assert "found the problem 'chains', expected one of accelerations, andrews" in result.output
    assert "accelerations_in_plane_10" in result.output


def test_the_time_at_an_error_is_read_from_a_line_through_the_sweep():
    """Solvers whose error is their tolerance and whose time is its power -1/5, one twice as slow; one that fails."""

    def spinning(factor):
        def at(rtol):
            def solve():
                end = time.process_time() + factor * 1e-4 * rtol**-0.2
                while time.process_time() < end:
                    pass
                return np.array([rtol])

            return solve

        return at

    def failing(rtol):
        raise Failed("never")

    def contestants():
        return [Contestant("one", False, spinning(1)), Contestant("two", True, spinning(2))]

    problem = Problem("spin", lambda: np.zeros(1), contestants, rounds=3)
    rows = problem.measured()
    found = {row.solver: row.seconds for row in at_target_rows(rows)}
    assert found["one"] == pytest.approx(1e-4 * 1e-6**-0.2, rel=0.1)
    assert found["two"] == pytest.approx(2 * found["one"], rel=0.1)
    assert all(10**-7.6 < row.error < 10**-4.4 for row in rows)


def test_a_table_names_its_error_and_a_ratio_where_there_is_a_yardstick():
    alone = Row("bdf", "at error 0.0001", 1e-4, 0.1, False)
    beside = [Row(name, "at error 1e-06", 1e-6, 0.1, name == "yardstick") for name in ("bdf", "yardstick")]
    assert next(table("car", [alone])) == "car: time at an error of 0.0001"
    assert next(table("car", beside)) == "car: time at an error of 1e-06, and its ratio to the yardstick"


def test_contestants_that_never_arrive_are_left_out():
    def at(rtol):
        def solve():
            raise Failed("never")

        return solve

    problem = Problem("none", lambda: np.zeros(1), lambda: [Contestant("one", False, at)])
    assert problem.measured() == []


@pytest.mark.parametrize("car", CARS, ids=lambda car: car.name)
@pytest.mark.sampled(4)
def test_places_of_a_car_are_off_by_little_more_than_one_error_at_the_start_makes(car):
    rows = Conditioning(car).measured()
    of_starts = max(row.error / RTOLS[0] for row in rows if row.solver != "bdf")
    for row, rtol in zip((row for row in rows if row.solver == "bdf"), RTOLS, strict=True):
        assert row.error / rtol < 10 * of_starts
