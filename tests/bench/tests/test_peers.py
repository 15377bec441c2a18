"""Other tools on the benchmark problems: all solve the same problem, and times are read and compared as they should be.

Those of the extra ``peers`` are left out where they are not installed.
"""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from stiffmbs.compile.compile_model import compile_model
from stiffmbs.dynamics.dynamics import Dynamics
from stiffmbs.dynamics.initial import initial_values
from stiffmbs.solve.explicit.projected import TRAITS
from stiffmbs.solve.formulations import FORMULATIONS
from tests.bench.__main__ import bench
from tests.bench.benchmark import Row, families
from tests.bench.contestant import Contestant, Failed
from tests.bench.decades import SET_UP, at_errors, error_of, over_decades, races
from tests.bench.figure import draw
from tests.bench.own_solvers import OwnSolvers, exact_of
from tests.bench.peers import missing, peers
from tests.bench.peers.absolute import Maths, constraints, forces
from tests.bench.peers.mechanism import mechanism_of
from tests.bench.peers.scipy import explicit, states
from tests.bench.peers.segments import segments_of
from tests.bench.problems.stiffness import OverStiffness
from tests.bench.sweep import at_target_rows

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

PROBLEMS = {name: families()[name][0] for name in ("andrews", "cart_pendulum", "chain", "half_car")}
LOOSE = {"lambdify and NumPy": 1.0, "Exudyn generalised-alpha": 5e-3}
"""Errors at a moderate step of methods of order 1 and 2."""
NUMPY = Maths(np.sin, np.cos, np.sqrt, min, max)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if name in ("andrews", "half_car") else ()) for name in PROBLEMS]
)
def test_all_tools_solve_the_same_problem(name):
    problem = PROBLEMS[name]
    reference = problem.reference()
    for peer in peers(problem.task()):
        steps = [step for step in peer.settings if step <= 0.4 * (problem.task().times[1] - problem.task().times[0])]
        setting = steps[0] if steps else 1e-8
        if (name, peer.solver) == ("andrews", "CasADi IDAS SI2"):
            with pytest.raises(Failed, match="IDASolve"):
                peer.at(setting)()
            continue
        error = error_of(peer.at(setting)(), reference)
        assert error < LOOSE.get(peer.solver, 1e-4), peer.solver


def test_the_plain_solver_converges_with_the_first_power_of_its_step():
    problem = PROBLEMS["cart_pendulum"]
    (plain,) = (peer for peer in peers(problem.task()) if peer.solver == "lambdify and NumPy")
    reference = problem.reference()
    coarse, fine = (error_of(plain.at(step)(), reference) for step in (5e-3, 2.5e-3))
    assert coarse / fine == pytest.approx(2, rel=0.1)


def test_every_tool_has_a_contestant():
    found = " ".join(peer.solver for peer in peers(PROBLEMS["cart_pendulum"].task()))
    optional = {"exudyn": "Exudyn", "casadi": "CasADi"}
    expected = {"SciPy", "NumPy", *(tool for package, tool in optional.items() if package not in missing())}
    assert all(tool in found for tool in expected), found


@pytest.mark.parametrize("name", PROBLEMS)
def test_equations_for_other_tools_are_those_of_this_package(name):
    scene = PROBLEMS[name].task().scene
    m, dynamics = mechanism_of(scene), Dynamics(compile_model(scene))
    start = initial_values(dynamics, 0.0)
    np.testing.assert_allclose(start.q, m.start, atol=1e-12)
    assert np.max(np.abs(constraints(m, m.start, NUMPY)), initial=0.0) < 1e-12
    rest = np.zeros(m.n)
    f = np.array(forces(m, 0.0, m.start, rest, NUMPY))
    J = np.array([_slope(m, k) for k in range(m.n)]).T
    block = np.block([[np.diag(m.mass), J.T], [J, np.zeros((len(J), len(J)))]])
    found = np.linalg.lstsq(block, np.concatenate([f, np.zeros(len(J))]))[0][: m.n]
    report = dynamics.report(np.zeros(1), start.q[None], start.u[None], project=False)
    np.testing.assert_allclose(found, report.acceleration[0], rtol=1e-6, atol=1e-6 * np.abs(found).max() + 1e-9)


def _slope(m, k):
    d = np.zeros(m.n)
    d[k] = 1e-6
    plus, minus = (np.array(constraints(m, m.start + s * d, NUMPY)) for s in (1, -1))
    return (plus - minus) / 2e-6


def test_the_jacobian_of_the_half_car_is_the_derivative_of_its_rates():
    minimal = PROBLEMS["half_car"].task().minimal
    y, h = minimal.start + 1e-2 * np.random.default_rng(3).normal(size=18), 1e-6
    expected = np.stack(
        [(minimal.rates(0.1, y + d) - minimal.rates(0.1, y - d)) / (2 * h) for d in h * np.eye(18)], axis=1
    )
    np.testing.assert_allclose(minimal.jacobian(0.1, y), expected, atol=1e-8 * np.abs(expected).max())


def test_legs_meet_all_output_times_once():
    times = np.linspace(0.0, 1.0, 11)
    segments = list(segments_of(times, (0.25, 0.5)))
    assert [segment[[0, -1]].tolist() for segment, _ in segments] == [[0.0, 0.25], [0.25, 0.5], [0.5, 1.0]]
    inside = np.concatenate([segment[1 : count + 1] for segment, count in segments])
    np.testing.assert_array_equal(inside, times[1:])


def _spent(seconds):
    """A contestant's clock: it spins for so long."""
    import time

    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


def _contestant(name, peer, order, cost, settings=()):
    def at(setting):
        def solve():
            _spent(cost * setting ** (-1 / order))
            return np.array([[setting]])

        return solve

    return Contestant(name, peer, at, "step" if settings else "rtol", settings)


def test_times_at_errors_and_the_best_of_each_side():
    """Times that go with a power of the error; one contestant has three settings only, between which it is read."""
    own, peer = _contestant("own", False, 4, 1e-5), _contestant("peer", True, 8, 1e-4)
    few = _contestant("few", True, 4, 9e-5, settings=(1e-3, 1e-5, 1e-7))
    targets = (1e-4, 1e-8, 1e-9)
    rows = over_decades([own, peer, few], np.zeros((1, 1)), targets, rounds=3)
    times = {(row.solver, row.error): row.seconds for row in at_target_rows(rows)}
    assert times[("few", 1e-4)] == pytest.approx(9e-5 * 10, rel=0.15)
    found = list(races(rows, targets))
    assert [(race.best_own, race.best_peer) for race in found] == [("own", "peer")] * 3
    expected = [10 * error ** (1 / 8) for error in targets]
    assert [race.ratio for race in found] == pytest.approx(expected, rel=0.15)
    assert {row.solver for row in rows if row.setting == SET_UP} == {"own", "peer", "few"}


def test_a_first_solution_that_compiles_ends_no_sweep(monkeypatch):
    monkeypatch.setattr("tests.bench.decades.LONGEST", 0.2)
    solved = []

    def solve(setting):
        _spent(0.0 if solved else 0.3)
        solved.append(setting)
        return np.array([[setting]])

    once = Contestant("compiled", False, lambda setting: lambda: solve(setting), settings=(1e-3, 1e-4, 1e-5))
    rows = over_decades([once], np.zeros((1, 1)), (1e-4,), rounds=1)
    assert {row.error for row in rows if row.setting.startswith("rtol")} == {1e-3, 1e-4, 1e-5}


def test_a_solver_that_is_more_accurate_than_asked_counts_with_its_shortest_time():
    rows = [Row("own", f"rtol {e:g}", e, 1e-3 * e**-0.1, False) for e in (1e-6, 1e-7)]
    (found,) = at_errors("own", False, rows, [1e-3])
    assert (found.seconds, found.error) == (rows[0].seconds, 1e-3)
    assert not list(at_errors("own", False, rows, [1e-9]))


def test_looser_settings_that_take_longer_make_no_solver_slower():
    """As where steps follow stability: the line through all of them would say more than one of them takes."""
    rows = [
        Row("own", f"rtol {e:g}", e, seconds, False)
        for e, seconds in ((3e-2, 5.0), (2e-2, 4.0), (8e-3, 2.0), (1e-3, 2.5))
    ]
    (found,) = at_errors("own", False, rows, [1e-2])
    assert (found.seconds, found.error) == (2.0, 1e-2)


def test_errors_count_where_a_solution_has_values():
    reference = np.zeros((3, 2))
    assert error_of(np.array([[0.0, 0.0], [np.nan, np.nan], [0.5, 0.1]]), reference) == 0.5
    assert error_of(np.array([[0.0, 0.0], [np.nan, 1.0], [0.5, 0.1]]), reference) == np.inf


def test_a_figure_is_drawn(tmp_path):
    rows = [Row("bdf", f"rtol {e:g}", e, 1e-3 * e**-0.2, False) for e in (1e-4, 1e-6)]
    path = draw("pendulum", [*rows, Row("bdf", SET_UP, 0.0, 1.0, False)], tmp_path / "figures")
    assert path.name == "pendulum.svg"
    assert path.stat().st_size > 1000


def test_quick_look_at_peers_in_json(tmp_path):
    result = CliRunner().invoke(bench, ["--quick", "--json", "--peers", "--plot", str(tmp_path), "andrews"])
    assert result.exit_code == 0, result.output
    report = json.loads(result.stdout)
    assert report.keys() == {"problem", "machine", "rows"}
    assert {"bdf", "SciPy LSODA"} <= {row["solver"] for row in report["rows"]}
    assert (tmp_path / "andrews.svg").exists()


def test_solvers_of_this_package_are_measured_in_positions_velocities_and_reactions():
    rows = OwnSolvers(PROBLEMS["cart_pendulum"]).glanced()
    found = {row.solver.partition(":")[0] for row in rows}
    assert found == {*(f"bdf {name}" for name in FORMULATIONS), *TRAITS}
    for quantity in ("positions", "velocities", "reactions"):
        assert sum(row.solver.endswith(quantity) for row in rows) == len(found)


def test_exact_velocities_and_reactions_of_the_cart_pendulum():
    """The rail's upward force at 5 s is 107.1068184413 N; velocities are the rates of the positions."""
    task = PROBLEMS["cart_pendulum"].task()
    exact = exact_of(task)
    rates = task.minimal.rates(0.0, states(task, explicit, 1e-13)[500])
    assert exact.u[500, 0] == pytest.approx(rates[0], abs=1e-12)
    np.testing.assert_allclose(exact.lam[500, 0], -107.1068184413, atol=1e-8)


def test_stiffness_is_measured_at_both_ends():
    rows = OverStiffness((1e4, 1e5)).glanced()
    assert [(row.solver, row.setting) for row in rows] == [
        (solver, k) for k in ("1e+04 N/m", "1e+05 N/m") for solver in ("bdf", "dop853", "yardstick")
    ]
    assert max(row.error for row in rows) < 1e-6
