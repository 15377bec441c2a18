"""The driver of IDA: the same steps as scikit-sundae's, its history, events, failures, and what it frees."""

import gc
import os
import threading
import weakref
from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Contact, Model, Revolute
from stiffmbs.analyses.job import prepare
from stiffmbs.compile.equations import Equations
from stiffmbs.compile.state import State
from stiffmbs.solve.formulations import SI2_EXACT
from stiffmbs.solve.ida import choice, operations
from stiffmbs.solve.ida.choice import chosen
from stiffmbs.solve.ida.ida import NativeIda
from stiffmbs.solve.ida.statistics import Status
from stiffmbs.solve.linear_solvers.block_lu import BlockLU
from stiffmbs.solve.linear_solvers.sparse_lu import SparseLU
from stiffmbs.sparse.elimination_order import EliminationOrder, elimination_order
from stiffmbs.tuning import parameters_of
from tests.by_callbacks import ByScikitSundae


def begin(ida, t, y, yp, first_step=0.0, highest_order=5):
    """Start or restart IDA at consistent values."""
    if ida.begun:
        ida.counters.arrays["counts"][:] = [*ida.counters.total().values()]
    ida.y[:], ida.yp[:] = y, yp
    ida.ask("IDAReInit", t, ida.y_vector, ida.yp_vector)
    ida.ask("IDASetInitStep", first_step)
    ida.ask("IDASetMaxOrd", highest_order)
    ida.watch.begin()
    for cell, value in (("returned", t), ("internal", t), ("size", 0.0), ("tiny", 0)):
        ida.cells[cell] = value
    ida.begun_at(t)


class Problem:
    """A model's consistent start, its SI2 equations and its tolerances, multipliers out of the error test."""

    def __init__(self, model, rtol=1e-6):
        job = prepare(model)
        self.system, start = job.dynamics.system, job.start
        self.equations = Equations(SI2_EXACT, self.system)
        n, at = self.equations.n, self.equations.at
        self.rtol, self.atol = rtol, np.full(n, 1e15)
        self.atol[at["q"]] = self.atol[at["u"]] = rtol
        self.multipliers = self.atol > 1
        self.y, self.yp = np.zeros(n), np.zeros(n)
        self.y[at["q"]], self.y[at["u"]], self.y[at["lam"]] = start.q, start.u, start.lam
        self.yp[at["q"]], self.yp[at["u"]] = start.u, start.acceleration

    def native(self, **options):
        matrix = options.pop("matrix", None) or sparse_lu(self.equations)
        atol, state = options.pop("atol", self.atol), options.pop("state", None) or State(self.system)
        return NativeIda(self.equations, state, matrix, self.rtol, atol, **options)

    def through(self, ida, times, first_step=0.0, highest_order=5):
        """Begin, and report at the times, however many calls that takes."""
        begin(ida, 0.0, self.y, self.yp, first_step, highest_order)
        rows = np.empty((len(times), self.equations.n))
        done, status = 0, Status.GOING
        while status is Status.GOING:
            served, status = ida.advance(times[done:], times[-1], rows[done:])
            done += served
        return rows[:done], status

    def through_scikit_sundae(self, times):
        ida = ByScikitSundae(self.equations, State(self.system), self.rtol, self.atol)
        return ida.rows(self.y, self.yp, times), ida


@pytest.fixture(scope="module")
def pendulum(examples):
    return Problem(stiffmbs.load_scene(examples / "cart_pendulum.yaml"), rtol=1e-8)


@pytest.fixture(scope="module")
def squeezer(examples):
    return Problem(stiffmbs.load_scene(examples / "andrews.yaml"))


def hanging_chain():
    """Twelve rods of 1 m hinged to one another, let go from the horizontal: 120 unknowns."""
    model, end = Model("Chain", gravity=(0, -9.81)), "ground"
    for k in range(12):
        rod = model.add(f"rod{k}", Body(mass=1.0, inertia=1 / 12, position=(k + 0.5, 0)))
        model.add(f"pin{k}", Revolute(i=rod.at(-0.5, 0), j=end))
        end = rod.at(0.5, 0)
    return model


@pytest.fixture(scope="module")
def chain():
    return Problem(hanging_chain())


@pytest.fixture(scope="module")
def ball():
    """A body of 1 kg that falls 1 m onto a stiff, elastic floor."""
    model = Model("Ball", gravity=(0, -9.81))
    body = model.add("ball", Body(mass=1.0, inertia=0.1, position=(0, 1)))
    model.add("floor", Contact(i=body.at(0, 0), j="ground", stiffness=1e5))
    return Problem(model, rtol=1e-8)


@pytest.mark.parametrize(("name", "end"), [("pendulum", 0.5), ("chain", 0.5), ("squeezer", 0.01)])
def test_the_steps_are_those_of_scikit_sundae(name, end, request):
    """The linear solvers differ by rounding, which the steps amplify."""
    problem, times = request.getfixturevalue(name), np.linspace(0, end, 101)[1:]
    native = problem.native()
    rows, status = problem.through(native, times)
    expected, sundae = problem.through_scikit_sundae(times)
    assert status is Status.STOP
    counted = native.counters.counted()
    assert (counted["residuals"], counted["jacobians"]) == pytest.approx((sundae.residuals, sundae.jacobians), rel=0.02)
    at = np.concatenate([problem.equations.at[name] for name in "qu"])
    np.testing.assert_allclose(rows[:, at], expected[:, at], rtol=0.1 * problem.rtol, atol=0.1 * problem.rtol)


def sparse_lu(equations):
    return SparseLU(equations.n, *equations.pattern, elimination_order(equations))


def block_lu(equations):
    return BlockLU.of(equations, elimination_order(equations))


KINDS = {"sparse LU": sparse_lu, "blocks in a fixed order": block_lu}


def test_both_linear_solvers_give_the_same_motion(chain):
    rows = []
    for kind, made in KINDS.items():
        matrix = made(chain.equations)
        assert matrix.sentence().startswith(kind)
        found, status = chain.through(chain.native(matrix=matrix), np.array([0.2, 0.4]))
        assert status is Status.STOP
        rows.append(found[:, np.concatenate([chain.equations.at["q"], chain.equations.at["u"]])])
    np.testing.assert_allclose(*rows, atol=1e-7)


def test_the_linear_solver_is_that_of_the_least_estimated_cost(chain, monkeypatch):
    monkeypatch.setattr(choice, "COSTS", replace(parameters_of(choice.COSTS), worth_compiling=np.inf))
    assert isinstance(chosen(chain.equations)[0], SparseLU), "blocks would save too little to be compiled"
    monkeypatch.setattr(choice, "COSTS", replace(parameters_of(choice.COSTS), worth_compiling=0.0))
    assert isinstance(chosen(chain.equations)[0], BlockLU)
    monkeypatch.setattr(BlockLU, "cost", np.inf)
    assert isinstance(chosen(chain.equations)[0], SparseLU)


def test_blocks_of_a_long_chain_come_from_memory():
    """Per node they cost more than where a cache holds them all, and entry by entry the chain is solved faster."""

    def cost(rods):
        n, nodes = 10 * rods, 3 * rods
        order = EliminationOrder(np.arange(n), fill=10 * n, updates=100 * n)
        nothing = np.empty(0, dtype=np.int64)
        pattern = n, nothing, nothing, order
        return BlockLU(*pattern, [nothing] * nodes, nothing).cost / SparseLU(*pattern).cost

    assert cost(100) < 1 < cost(3000)


@pytest.mark.parametrize("kind", KINDS)
def test_pivots_are_sought_anew_where_they_have_become_small(chain, kind):
    """The order found far from the start, where the matrix is another one, serves all the same."""
    ida = chain.native(matrix=KINDS[kind](chain.equations))
    for scale in (1e-6, 1e6):  # cj is the inverse of the step: from 1e6 to 1 and back
        begin(ida, 0.0, chain.y, chain.yp, first_step=1e-6 * scale)
        _, status = ida.advance(np.array([0.1]), 0.1, np.empty((1, chain.equations.n)))
        assert status is not Status.FAILED
    rows, _ = chain.through(ida, np.array([0.4]))
    expected, _ = chain.through(chain.native(), np.array([0.4]))
    at = np.concatenate([chain.equations.at["q"], chain.equations.at["u"]])
    np.testing.assert_allclose(rows[:, at], expected[:, at], atol=1e-6)


def test_other_layouts_of_linear_solvers_are_refused(examples, monkeypatch):
    """A run stops with a sentence that names the remedy, and nothing is written into unknown memory."""
    monkeypatch.setattr(operations, "MOST_WORDS", 1)
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    with pytest.raises(
        stiffmbs.SolverError, match="lay out linear solvers in another way; expected the libraries of a"
    ):
        stiffmbs.run(scene, solver="bdf")
    assert stiffmbs.run(scene, solver="projected").message == "completed"


def test_history_tells_time_order_and_size_of_each_step(pendulum):
    ida = pendulum.native()
    pendulum.through(ida, np.array([2.0]))
    (t, order, size), counted = ida.history.stored(), ida.counters.counted()
    assert ida.history.count == len(t) == counted["steps"]
    np.testing.assert_allclose(np.diff(t), size[1:], atol=1e-14)
    assert t[-1] == pytest.approx(2.0, abs=1e-13)
    assert set(order) == {1, 2, 3, 4, 5}
    assert order[-1] == counted["order"]
    assert counted["newton_iterations"] >= counted["steps"]
    assert counted["rejected"] == counted["error_test_failures"] + counted["convergence_failures"] > 0


def test_order_and_step_stay_below_their_limits(pendulum):
    ida = pendulum.native(max_step=1e-3)
    pendulum.through(ida, np.array([0.5]), highest_order=2)
    _, order, size = ida.history.stored()
    assert order.max() == 2
    assert size.max() <= 1e-3 * (1 + 1e-12)


def test_own_steps_are_those_of_the_history(pendulum):
    ida = pendulum.native(reported=pendulum.equations.at["q"])
    begin(ida, 0.0, pendulum.y, pendulum.yp)
    t, q, count, status = np.empty(10_000), np.empty((10_000, 6)), 0, Status.GOING
    while status is Status.GOING:
        taken, status = ida.steps(1.0, t[count:], q[count:])
        count += taken
    np.testing.assert_allclose(t[:count], ida.history.stored()[0], atol=1e-14)
    assert t[count - 1] == ida.t == 1.0
    np.testing.assert_array_equal(q[count - 1], ida.y[pendulum.equations.at["q"]])


def test_it_begins_again_as_new(pendulum):
    times = np.linspace(0, 1, 11)[1:]
    ida = pendulum.native()
    first, _ = pendulum.through(ida, times)
    steps = ida.counters.counted()["steps"]
    again, _ = pendulum.through(ida, times)
    np.testing.assert_array_equal(first, again)
    assert ida.counters.counted()["steps"] == ida.history.count == 2 * steps


def test_the_worst_unknown_is_the_one_with_the_tightest_tolerance(pendulum):
    atol = np.full(pendulum.equations.n, 1e15)
    speed = pendulum.equations.at["u"][5]
    atol[speed] = 1e-8
    ida = pendulum.native(atol=atol)
    pendulum.through(ida, np.array([0.5]))
    assert ida.worst()[0] == speed
    assert 0 < ida.worst()[1] < np.sqrt(len(atol))


def test_a_call_stops_where_the_ball_meets_the_floor(ball):
    ida = ball.native()
    begin(ida, 0.0, ball.y, ball.yp)
    times, rows = np.linspace(0, 1, 101), np.empty((101, ball.equations.n))
    served, status = 0, Status.GOING
    while status is Status.GOING:
        more, status = ida.advance(times[served:], 1.0, rows[served:])
        served += more
    assert status is Status.ROOT
    assert list(ida.roots()) == [1]  # above zero where the surfaces push
    assert ida.t == pytest.approx(np.sqrt(2 / 9.81), abs=1e-8)
    assert served == 46  # the times up to 0.45 s
    np.testing.assert_allclose(rows[:46, 1], 1 - 9.81 * times[:46] ** 2 / 2, atol=1e-7)
    assert ida.y[1] == pytest.approx(0, abs=1e-7)
    begin(ida, ida.t, ida.y.copy(), ida.yp.copy())
    ends, _, sizes = ida.history.stored()
    assert ends[-1] == ida.t  # the step ends where it was cut short
    assert sizes.sum() == pytest.approx(ida.t, abs=1e-14)


def sliding(force):
    """A body of 1 kg that moves along x at 1 m/s under a force in that direction."""
    model = Model("Sliding", gravity=(0, 0))
    body = model.add("body", Body(mass=1, inertia=1, velocity=(1, 0)))
    model.add("force", AppliedForce(i=body.at(0, 0), force=(force, 0)))
    return Problem(model, rtol=1e-6)


def test_a_residual_without_a_value_cuts_the_step_alone():
    """A wall at x = 1 m, behind which its force is not defined: the body is thrown back as fast as it came."""
    wall = sliding("-1e-3*sqrt(1 - body.x)^-3")
    ida = wall.native()
    _, status = wall.through(ida, np.array([2.0]), first_step=1.9)  # through the wall
    assert status is Status.STOP
    assert ida.counters.counted()["convergence_failures"] > 0
    np.testing.assert_allclose(ida.y[[0, 3]], (0, -1), atol=0.01)


def test_a_run_into_the_undefined_fails_in_words():
    undefined = sliding("1 + sqrt(1 - body.x)")
    ida = undefined.native()
    rows, status = undefined.through(ida, np.linspace(0, 2, 201)[1:])
    assert status is Status.FAILED
    assert "no solution was found beyond" in ida.failure()
    assert 0.99 < ida.y[0] <= 1
    assert 0 < len(rows) < 200
    assert np.all(np.isfinite(rows))


def test_a_stop_behind_the_time_reached_is_refused(pendulum):
    ida = pendulum.native()
    pendulum.through(ida, np.array([1.0]))
    with pytest.raises(ValueError, match="invalid argument"):
        ida.advance(np.empty(0), 0.2, np.empty((0, ida.y.size)))


@pytest.mark.parametrize("shape", [(3, 20), (2, 19)])
def test_output_rows_of_another_shape_are_refused(pendulum, shape):
    ida = pendulum.native()
    begin(ida, 0.0, pendulum.y, pendulum.yp)
    with pytest.raises(ValueError, match=r"output rows: .* expected float64 of \(2, 20\)"):
        ida.advance(np.array([0.1, 0.2]), 0.2, np.empty(shape))


def test_two_threads_solve_what_one_does(pendulum):
    times, found = np.linspace(0, 5, 51)[1:], {}
    expected, _ = pendulum.through(pendulum.native(), times)

    def work(name):
        ida = pendulum.native()
        found[name] = [pendulum.through(ida, times)[0] for _ in range(20)]

    threads = [threading.Thread(target=work, args=(k,)) for k in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for rows in (rows for several in found.values() for rows in several):
        np.testing.assert_array_equal(rows, expected)


@pytest.mark.long
def test_everything_is_freed(chain):
    def memory():
        gc.collect()
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    if not os.path.exists("/proc/self/statm"):
        pytest.skip("no /proc here")

    def some(count):
        for _ in range(count):
            ida = chain.native()
            begin(ida, 0.0, chain.y, chain.yp)
            ida.advance(np.empty(0), 1e-6, np.empty((0, ida.y.size)))

    some(20)
    before = memory()
    some(60)
    assert memory() - before < 3e6  # one instance of 120 unknowns holds 0.1 to 0.2 MB


def test_closing_twice_and_failing_at_the_start_are_harmless(pendulum):
    ida = pendulum.native()
    alive = weakref.ref(ida)
    ida.close()
    ida.close()
    del ida
    assert alive() is None
    with pytest.raises(ValueError, match=r"atol: found shape \(3,\), expected \(20,\)"):
        pendulum.native(atol=np.ones(3))
    with pytest.raises(ValueError, match="invalid argument"):
        pendulum.native(max_step=-1.0)


def test_a_forked_process_goes_on_by_itself(pendulum):
    times = np.array([1.0])
    ida = pendulum.native()
    expected, _ = pendulum.through(ida, times)
    child = os.fork()
    if child == 0:
        rows, _ = pendulum.through(ida, times)
        os._exit(0 if np.array_equal(rows, expected) else 1)
    assert os.waitpid(child, 0)[1] == 0
    np.testing.assert_array_equal(pendulum.through(ida, times)[0], expected)
