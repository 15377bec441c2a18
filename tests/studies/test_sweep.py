"""Studies: the cases of a table are those that single runs give, whatever is varied and wherever they are solved."""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from threading import Event
from time import sleep

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, Range, sweep
from stiffmbs.studies.case_solver import CaseSolver
from stiffmbs.studies.executors import executor_of
from stiffmbs.studies.sweep import study_of

SHORT = {"duration": 0.3, "rtol": 1e-6}


def alone(path, changes, output, **settings):
    """What a single run of a changed scene gives."""
    solution = stiffmbs.run(stiffmbs.load_scene(path, changes), **settings)
    return np.max(np.abs(solution[output]))


@pytest.mark.long
def test_a_grid_holds_what_single_runs_give_to_the_last_bit(examples):
    path, k_b, zeta = examples / "half_car.yaml", np.logspace(5, 8, 3), [0.02, 0.1]
    found = sweep(path, k_b=k_b, zeta=zeta, outputs=["peak(front_bushing.fx)", "chassis.y"], **SHORT)
    assert found["peak(front_bushing.fx)"].dims == ("k_b", "zeta")
    for k in k_b:
        for z in zeta:
            changes = [("k_b", repr(float(k))), ("zeta", repr(z))]
            expected = stiffmbs.run(stiffmbs.load_scene(path, changes), **SHORT)
            one = found.sel(k_b=k, zeta=z)
            assert one["peak(front_bushing.fx)"] == np.max(np.abs(expected["front_bushing.fx"]))
            np.testing.assert_array_equal(one["chassis.y"], expected["chassis.y"])
            np.testing.assert_array_equal(found.time, expected.time)


def test_cases_of_one_structure_are_assembled_once(examples, monkeypatch):
    study = study_of(examples / "chain.yaml", {}, None, 0, ["final(link1.y)"], {"N": [2, 4, 2, 4], **SHORT})
    solver, prepared = CaseSolver(study.task), []
    from stiffmbs.studies import case_solver

    def counted(*given):
        prepared.append(given)
        return real(*given)

    real = case_solver.prepare
    monkeypatch.setattr(case_solver, "prepare", counted)
    ends = [solver.row(case, values).values[0] for case, values in enumerate(study.cases)]
    assert ends[:2] == ends[2:] and ends[0] != ends[1]
    assert len(prepared) == 2


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("forces.spring.stiffness", [100.0, 400.0]),
        ("bodies.bar.mass", [1.0, 3.0]),
        ("gravity", [[0.0, -9.81], [0.0, -1.6]]),
        ("bodies.cart.velocity", [[0.5, 0.0], [1.0, 0.0]]),
        ("joints.hinge.j.point", [[-0.2, 0.0], [-0.3, 0.0]]),
        ("run.rtol", [1e-5, 1e-9]),
        ("run.solver", ["bdf", "projected"]),
        ("start", [0.1, 0.5]),
    ],
)
def test_anything_of_a_scene_is_varied(examples, name, values):
    path = examples / "cart_pendulum.yaml"
    set_up = [("joints.hinge.j", "{body: bar, point: [-0.3, 0]}")] if name.startswith("joints") else []
    scene = stiffmbs.load_scene(path, set_up)
    found = sweep(scene, {name: values}, outputs="peak(rail.fy)", duration=0.5)
    assert found.status.values.tolist() == ["done", "done"]
    for k, value in enumerate(values):
        assert found["peak(rail.fy)"].values[k] == alone(path, [*set_up, (name, str(value))], "rail.fy", duration=0.5)


def test_matrices_have_a_dimension_of_numbers_and_their_entries_beside_it():
    text = """
        bodies: {a: {mass: 1, inertia: 1, position: [0.1, 0]}}
        forces: {b: {type: bushing, i: a, j: ground, stiffness: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], damping: [0, 0, 0]}}
    """
    matrices = np.array([np.diag([100.0, 1.0, 1.0]), np.diag([400.0, 1.0, 1.0])])
    found = sweep(
        stiffmbs.read_scene(text), {"forces.b.stiffness": matrices}, outputs={"x": "a.x"}, duration=1, points=11
    )
    np.testing.assert_array_equal(found["forces.b.stiffness"], matrices)
    expected = 0.1 * np.cos(np.sqrt([[100.0], [400.0]]) * found.time.values)
    np.testing.assert_allclose(found.x, expected, atol=1e-5)


@pytest.mark.long
def test_samples_are_stratified_within_their_ranges_and_the_same_each_time(examples):
    path = examples / "cart_pendulum.yaml"

    def sampled(kind):
        varied = {"L": Range(0.4, 0.8), "forces.spring.stiffness": Range(1.0, 1e4, log=True)}
        return sweep(path, varied, sample=f"{kind}:8", outputs="final(cart.x)", duration=0.1, points=2)

    for kind in ("lhs", "sobol", "random"):
        found, again = sampled(kind), sampled(kind)
        assert found.identical(again)
        assert found["final(cart.x)"].dims == ("case",)
        parts = np.log(found["forces.spring.stiffness"].values) / np.log(1e4)
        assert parts.min() >= 0 and parts.max() <= 1
        if kind != "random":  # one in each eighth
            np.testing.assert_array_equal(np.sort((parts * 8).astype(int)), np.arange(8))


def test_a_case_that_fails_is_a_row_with_its_message(examples):
    found = sweep(
        examples / "cart_pendulum.yaml", {"bodies.bar.mass": [1.0, -1.0]}, outputs="peak(rail.fy)", duration=0.1
    )
    assert found.status.values.tolist() == ["done", "error"]
    assert np.isnan(found["peak(rail.fy)"].values[1])
    assert "found -1.0, expected a mass greater than 0" in str(found.message.values[1])


def test_outputs_have_the_units_of_their_channels(examples):
    outputs = ["peak(hinge.fy)", "t_max(bar.omega)", "bar.angle", "integral(bar.x)", "rms(bar.ax)/9.81"]
    found = sweep(examples / "bar_pendulum.yaml", L=[0.5, 0.6], outputs=outputs, duration=0.1)
    assert [found[name].attrs.get("units") for name in outputs] == ["N", "s", "rad", None, None]


def test_reductions_and_formulas_of_a_channel():
    """A body thrown upwards: y = 2 t - g t^2 / 2."""
    text = (
        "{bodies: {a: {mass: 1, inertia: 1, velocity: [0, 2]}}, gravity: [0, -10], run: {duration: 0.4, points: 4001}}"
    )
    expected = {
        "final(a.y)": 0.0, "max(a.y)": 0.2, "t_max(a.y)": 0.2, "mean(a.vy)": 0.0, "rms(a.vy)": 2 / np.sqrt(3), "peak(a.vy)": 2.0,
        "integral(a.y)": 0.8 / 15, "first(a.vy)": 2.0, "t_peak(a.vy - 5)": 0.4, "2*max(a.y)^2 + 1": 1.08,
    }  # fmt: skip
    found = sweep(stiffmbs.read_scene(text), {"bodies.a.mass": [1.0]}, outputs=list(expected), rtol=1e-9)
    for name, value in expected.items():
        assert float(found[name][0]) == pytest.approx(value, abs=2e-7), name


def test_a_number_that_is_none_is_told(examples):
    found = sweep(examples / "cart_pendulum.yaml", L=[0.5], outputs={"a": "log(-peak(cart.x))"}, duration=0.1)
    assert found.status.values[0] == "done" and np.isnan(found.a.values[0])
    assert "output 'a': found nan, expected a finite number" in str(found.message.values[0])


def table(path, **how):
    return sweep(
        path,
        k_b=np.logspace(5, 7, 7),
        zeta=[0.02, 0.1],
        outputs=["peak(front_bushing.fx)", "chassis.y"],
        **SHORT,
        **how,
    )


@pytest.mark.long
def test_threads_and_processes_give_the_same_table_to_the_last_bit(examples):
    path = examples / "half_car.yaml"
    expected = table(path)
    assert table(path, workers=2).identical(expected)
    with ProcessPoolExecutor(2, get_context("spawn")) as processes:
        assert table(path, executor=processes).identical(expected)


def test_progress_counts_to_the_end_and_tells_the_time_left(examples):
    seen = []
    sweep(examples / "cart_pendulum.yaml", L=[0.5, 0.6, 0.7], duration=0.1, watch=lambda *now: seen.append(now))
    assert [now[:2] for now in seen] == [(1, 3), (2, 3), (3, 3)]
    assert seen[0][2] > 0 and seen[-1][2] == 0


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"vary": {}}, "found nothing to vary"),
        ({"vary": "L"}, "vary: found 'L', expected a list of variations"),
        ({"vary": {"L": [0.5]}, "workers": "2"}, "workers: found '2', expected a whole number"),
        ({"vary": {"LL": [1.0]}}, "LL: found no such parameter .*, expected one of L, start"),
        ({"vary": {"L": [0.5]}, "outputs": "peak(rial.fy)"}, "found no channel 'rial.fy'"),
        ({"vary": {"L": [0.5]}, "outputs": "peak(rail.fy"}, "found no formula"),
        ({"vary": {"L": [0.5]}, "outputs": "__import__('os')"}, "expected channels, numbers"),
        (
            {"vary": {"L": [0.5]}, "outputs": "max(fm(hinge))"},
            "a formula becomes a channel as a request of the scene: .*fm",
        ),
        ({"vary": {"L": Range(0.5, 1)}}, "found a range without a count"),
        ({"vary": {"L": Range(0.5, 1)}, "sample": "lhs"}, "found 'lhs', expected one of random:N"),
        ({"vary": {"L": 3}}, "L: found 3, expected a list"),
        ({"vary": {"L": []}}, "L: found no value"),
        ({"vary": {"run.duration": [1, 2]}, "outputs": "rail.fy"}, "found series with run.duration varied"),
        ({"vary": {"L": [0.5]}, "workers": 0}, "workers: found 0"),
    ],
)
def test_what_cannot_be_studied_is_refused(examples, given, sentence):
    with pytest.raises(InputError, match=sentence.replace("(", r"\(")):
        sweep(examples / "cart_pendulum.yaml", duration=0.1, **given)


def test_a_case_whose_formula_has_no_value_is_a_row_with_its_message():
    text = "parameters: {F: 4}\nbodies: {sled: {mass: 2, inertia: 1}}\nforces: {push: {type: force, i: sled, force: [sqrt(F), 0]}}"
    found = sweep(stiffmbs.read_scene(text), {"F": [4.0, -1.0]}, outputs="final(sled.vx)", duration=1.0)
    assert found.status.values.tolist() == ["done", "error"]
    assert found["final(sled.vx)"].values[0] == pytest.approx(1.0)
    assert str(found.message.values[1]).startswith("push: found 'sqrt(F)' in 'sqrt(F)', which has")


def test_an_interrupted_study_ends_the_runs_of_its_threads():
    """Ctrl-C reaches the main thread alone; the study waited for the runs of others to their end."""
    started = Event()

    def run(watch):
        started.set()
        for t in range(10**4):
            watch(t)
            sleep(1e-3)

    with pytest.raises(ValueError), executor_of(2, None) as (threads, _):
        under_way = threads.submit(run)
        started.wait()
        raise ValueError
    assert isinstance(under_way.exception(), KeyboardInterrupt)
