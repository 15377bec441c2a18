"""Tables outside their points: values of every interpolation, notes on departures, and drives by measured positions."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from stiffmbs import Body, Drive, InputError, Model, Prismatic, SolverError, Table, read_scene, run, simulation
from stiffmbs.compile.inputs.interval_arithmetic import Enclosure
from stiffmbs.compile.inputs.table_ranges import TableRanges
from stiffmbs.compile.table_values import curve, parts_of
from stiffmbs.elements.roads.rolling_filter import heights_of
from stiffmbs.run_checks.tables import _passes, _points

POINTS = ((-0.2, -100.0), (0.0, 0.0), (0.1, 30.0), (0.2, 100.0))
BUMP = ((0.0, 0.0), (0.5, 1.0), (1.2, 0.7), (2.0, 0.0))
INTERPOLATIONS = ({}, {"lines": True}, {"akima": True}, {"spline": True}, {"ends": "not-a-knot"}, {"ends": "clamped"})
SOLVERS = ("bdf", "radau", "projected", "auto")
SPRING = """
tables: {{push: {{table: [[-0.2, -100], [0, 0], [0.1, 30], [0.2, 100]]{options}}}}}
bodies: {{b: {{mass: 1, inertia: 1, velocity: [{speed}, 0]}}}}
joints: {{r: {{type: prismatic, i: b, j: ground}}}}
forces: {{s: {{type: force, i: b, force: ["-push(b.x)", 0]}}}}
run: {{duration: 2, points: {points}}}
"""
PULSE = """
tables: {{pulse: {{table: [[0, 0], [0.1, 100], [0.2, 0]]{options}}}}}
bodies: {{b: {{mass: 1, inertia: 1}}}}
joints: {{r: {{type: prismatic, i: b, j: ground}}}}
forces: {{s: {{type: force, i: b, force: ["pulse(t)", 0]}}}}
run: {{duration: 2, points: 11}}
"""


def spring(options: str = "", speed: float = 5.0, points: int = 2) -> object:
    return read_scene(SPRING.format(options=options, speed=speed, points=points))


def pulse(options: str) -> object:
    return read_scene(PULSE.format(options=options))


def departures(solution: object) -> list[str]:
    return [note for note in solution.notes if "was left for" in note]  # type: ignore[attr-defined]


def number_after(note: str, words: str) -> float:
    return float(note.partition(words)[2].split()[0].rstrip(":,;"))


@pytest.mark.parametrize("options", INTERPOLATIONS)
@pytest.mark.parametrize("beyond", ["extend", "hold", "error"])
def test_values_outside_of_a_table(options: dict[str, object], beyond: str) -> None:
    """Held values are those of the ends, extended ones follow the slope of the interpolation there."""
    table = Table(table=BUMP, beyond=beyond, **options)
    value, (_, pieces) = curve(table), parts_of(table)
    a, b, c, _ = pieces[-1]
    h = BUMP[-1][0] - BUMP[-2][0]
    slope = (0.0, 0.0) if beyond == "hold" else (pieces[0][2], (3 * a * h + 2 * b) * h + c)
    assert value(np.array([-1.5, 3.0])) == pytest.approx([-1.5 * slope[0], slope[1]], abs=1e-12)
    assert heights_of(table, np.array([-1.5, 3.0, 0.3])) == pytest.approx(value(np.array([-1.5, 3.0, 0.3])), abs=1e-12)


@pytest.mark.parametrize("options", INTERPOLATIONS[:4])
def test_a_repeated_table_is_smooth_where_it_repeats(options: dict[str, object]) -> None:
    value = curve(Table(table=BUMP, beyond="repeat", **options))
    x = np.linspace(0.1, 1.9, 7)
    assert value(x + 4.0) == pytest.approx(value(x), abs=1e-12)
    if "lines" not in options:
        (before, at, after), d = value(np.array([2 - 1e-6, 2.0, 2 + 1e-6])), 1e-6
        assert (at - before) / d == pytest.approx((after - at) / d, abs=1e-4)


def test_ends_that_contradict_what_is_beyond() -> None:
    for options in ({"ends": "periodic", "beyond": "hold"}, {"ends": "clamped", "beyond": "repeat"}):
        with pytest.raises(InputError, match="expected periodic ends"):
            Table(table=BUMP, **options)
    with pytest.raises(InputError, match="expected a periodic table to close"):
        Table(table=POINTS, beyond="repeat")


@pytest.mark.parametrize("beyond", ["extend", "hold", "repeat"])
@pytest.mark.parametrize("options", INTERPOLATIONS[:4])
def test_ranges_enclose_values_outside(options: dict[str, object], beyond: str) -> None:
    table = Table(table=BUMP, beyond=beyond, **options)
    rng = np.random.default_rng(3)
    low = rng.uniform(-3, 4, 200)
    high = low + rng.uniform(0, 1.5, 200)
    with np.errstate(all="ignore"):
        found = TableRanges(table).enclosed(Enclosure.of_time(low, high, 1)).value
    inside = curve(table)(low + np.linspace(0, 1, 41)[:, None] * (high - low))
    assert np.all(found[0] <= inside.min(axis=0) + 1e-9)
    assert np.all(found[1] >= inside.max(axis=0) - 1e-9)


@functools.cache
def displacements() -> tuple[np.ndarray, np.ndarray]:
    """Return times and displacements of the body of `spring`, by steps of another integrator."""
    from scipy.integrate import solve_ivp

    force = curve(Table(table=POINTS))
    exact = solve_ivp(
        lambda t, y: [y[1], -float(force(np.array([y[0]]))[0])], (0, 2), [0, 5], method="DOP853", rtol=1e-10, atol=1e-12,
        max_step=1e-3, dense_output=True,
    )  # fmt: skip
    t = np.linspace(0, 2, 200_001)
    return t, exact.sol(t)[0]


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("points", [2, 2001])
def test_a_departure_is_noted_with_its_distance_and_duration(solver: str, points: int) -> None:
    """A stiff output grid of two points sees no departure at all."""
    t, x = displacements()
    outside = (x > 0.2) | (x < -0.2)
    (note,) = departures(run(spring(points=points), solver=solver, rtol=1e-7))
    assert "s: the table 'push'" in note
    assert number_after(note, "left for ") == pytest.approx(np.mean(outside) * 2, rel=0.02)
    assert number_after(note, "first at t = ") == pytest.approx(t[np.argmax(outside)], abs=1e-5)
    assert number_after(note, "argument reaches ") == pytest.approx(
        x.max() if x.max() > -x.min() else x.min(), abs=1e-3
    )
    assert "state 'beyond'" in note


def test_fixed_steps_and_prescribed_motions_note_departures_at_outputs() -> None:
    fixed = run(spring(points=2001), solver="projected", scheme="rk4", step=1e-3)
    (note,) = departures(fixed)
    assert number_after(note, "argument reaches ") == pytest.approx(fixed["b.x"].max(), abs=1e-5)
    scene = SPRING.format(options="", speed=0, points=201).replace(
        "j: ground}}", "j: ground}, d: {type: drive, joint: r, position: 0.3*t}}"
    )
    (note,) = departures(run(read_scene(scene), solver="kinematic"))
    assert number_after(note, "first at t = ") == pytest.approx(2 / 3, abs=1e-6)
    assert number_after(note, "left for ") == pytest.approx(4 / 3, abs=1e-2)


def test_no_note_within_the_points_or_where_the_end_is_intended() -> None:
    assert not departures(run(spring(speed=2.0)))
    assert not departures(run(spring(options=", beyond: hold")))
    level = PULSE.format(options=", lines: true").replace("[0.2, 0]", "[0.2, 0], [0.3, 0]")
    assert not departures(run(read_scene(level)))
    (note,) = departures(run(spring(options=", beyond: extend")))
    assert "state 'beyond'" not in note


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_run_stops_where_a_table_with_error_is_left(solver: str) -> None:
    stopped = run(spring(options=", beyond: error"), solver=solver, rtol=1e-8)
    assert stopped.outcome.name == "STOPPED"
    assert (
        "the table 'push' of 's' was left (beyond: error): its argument passes its last point at 0.2" in stopped.message
    )
    assert stopped["b.x"][-1] == pytest.approx(0.2, abs=1e-6)
    timed = run(pulse(", lines: true, beyond: error"), solver=solver)
    assert timed.time[-1] == pytest.approx(0.2, abs=1e-9)


@pytest.mark.parametrize("solver", ["bdf", "radau", "projected", "auto"])
def test_steps_end_soon_after_a_table_with_error_is_left(solver: str) -> None:
    """They went on to the end of the run, which was then refused."""
    seen: list[float] = []
    run(spring(options=", beyond: error"), solver=solver, rtol=1e-6, duration=1e4, max_step=0.02, watch=seen.append)
    assert max(seen) < 2e3


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_simulation_stops_before_a_table_with_error_is_left(solver: str) -> None:
    sim = simulation(spring(options=", beyond: error"), solver=solver)
    with pytest.raises(SolverError, match="its argument passes its last point"):
        for _ in range(20):
            sim.step(0.01)
    assert sim.t == pytest.approx(0.04)
    assert sim["b.x"] < 0.2


def test_the_pulse_of_a_table_in_time() -> None:
    """10 N s accelerate 1 kg to 10 m/s if the table is held; extended lines give 10 - 0.5*1000*1.8^2 m/s, and a note."""
    held = run(pulse(", lines: true, beyond: hold"))
    assert held["b.vx"][-1] == pytest.approx(10.0, rel=1e-6)
    extended = run(pulse(", lines: true"))
    assert extended["b.vx"][-1] == pytest.approx(10 - 500 * 1.8**2, rel=1e-6)
    (note,) = departures(extended)
    assert number_after(note, "left for ") == pytest.approx(1.8, abs=1e-6)
    assert number_after(note, "continues it to ") == pytest.approx(-1800.0)


@pytest.mark.parametrize("solver", ["bdf", pytest.param("kinematic", marks=pytest.mark.long), "auto"])
def test_the_pump_of_the_manual(solver: str) -> None:
    """A drive by a table of velocities turns at ten times its last speed after ten times its duration."""
    scene = """
bodies: {s: {mass: 1, inertia: 1}}
joints: {p: {type: revolute, i: s, j: ground}, pump: {type: drive, joint: p, velocity: {table: [[0, 0], [1, 300 rpm]]OPTIONS}}}
run: {duration: 10}
"""
    extended = run(read_scene(scene.replace("OPTIONS", "")), solver=solver)
    (note,) = departures(extended)
    assert note.startswith("pump: the table 'velocity' was left for 9 s, first at t = 1 s")
    assert extended["s.omega"][-1] == pytest.approx(100 * np.pi)
    held = run(read_scene(scene.replace("OPTIONS", ", beyond: hold")), solver=solver)
    assert held["s.omega"][-1] == pytest.approx(10 * np.pi)
    assert not departures(held)


REQUEST = """
tables: {{m: {{table: [[0, 1], [1, 2], [2, 1]]{options}}}}}
bodies: {{b: {{mass: 1, inertia: 1, velocity: [5, 0]}}}}
joints: {{r: {{type: prismatic, i: b, j: ground}}}}
requests: {{q: "2*m(b.x)"}}
run: {{duration: 2, points: 41}}
"""


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_table_that_a_request_leaves_is_noted(solver: str) -> None:
    """Only tables of forces, states and drives were; the request was the table's slope at its end times the distance."""
    solution = run(read_scene(REQUEST.format(options="")), solver=solver)
    (note,) = departures(solution)
    assert note.startswith("q: the table 'm' was left for 1.6 s, first at t = 0.4 s: its argument reaches 10")
    assert not departures(run(read_scene(REQUEST.format(options=", beyond: hold"))))


def test_a_stated_continuation_has_no_value_in_its_note() -> None:
    """A formula may add to the table, as those of Adams' splines do: the table alone is another value."""
    (note,) = departures(run(read_scene(REQUEST.format(options=", beyond: extend"))))
    assert "8 beyond its last point at 2, where it is extrapolated (its points have values from 1 to 2)" in note
    assert not note.remedy
    assert note.kind == "table-extended"


def test_a_run_stops_where_a_request_leaves_a_table_with_error() -> None:
    solution = run(read_scene(REQUEST.format(options=", beyond: error")), points=30)
    assert not solution.success
    assert "the table 'm' of 'q' was left (beyond: error): its argument passes its last point at 2" in solution.message
    assert solution.time[-1] == pytest.approx(0.4, abs=1e-6)
    assert solution["q"].min() > 1.9


def test_an_input_array_that_ends_before_the_run_is_noted() -> None:
    scene = PULSE.format(options="").replace("tables:", "inputs: {f: 0}\ntables:").replace("pulse(t)", "f")
    given = {"f": ([0.0, 0.5, 1.0], [0.0, 1.0, 3.0])}
    (note,) = departures(run(read_scene(scene), inputs=given))
    assert "the table 'f' was left for 1 s, first at t = 1 s" in note
    assert not departures(run(read_scene(scene), inputs=given, duration=1.0))


FREQUENCY, AMPLITUDE = 2 * np.pi, 0.1


def shaken(table: Table) -> object:
    model = Model("shaker", gravity=(0, 0))
    model.add("b", Body(mass=2.0, inertia=1.0))
    model.add("r", Prismatic(i="b", j="ground"))
    model.add("d", Drive(joint="r", position=table))
    return model


def motion_notes(solution: object) -> list[str]:
    return [note for note in solution.notes if "the position by the table" in note]  # type: ignore[attr-defined]


def test_points_of_a_table_that_the_run_does_not_pass_have_no_note() -> None:
    table = Table(table=[(-1.0, -0.5), (1.0, 0.5), (2.0, 0.0)], lines=True)
    assert not motion_notes(run(shaken(table), duration=0.9))
    assert motion_notes(run(shaken(table), duration=1.1))


DRIVEN = """
gravity: [0, 0]
tables: {{measured: {{table: [[-1, -0.5], [1, 0.5], [2, 0]], lines: true}}}}
bodies: {{b: {{mass: 1, inertia: 1}}}}
joints:
  rail: {{type: prismatic, i: b, j: ground}}
  d: {{type: drive, joint: rail, position: "measured({argument}) + step(t, 0.3, 0, 0.6, 0.1)"}}
run: {{duration: 0.9, points: 3}}
"""


@pytest.mark.parametrize(("argument", "passed"), [("t", False), ("2*t", True), ("0.5*t", False), ("1.5 - t", True)])
def test_only_points_of_the_table_itself_have_a_note(argument: str, passed: bool) -> None:
    """The step has breakpoints of its own."""
    assert bool(motion_notes(run(read_scene(DRIVEN.format(argument=argument))))) is passed


@pytest.mark.long
def test_points_of_a_long_table_are_compared_with_the_nearest_breakpoints() -> None:
    """A measured motion of 200 000 samples has as many breakpoints: no matrix of all pairs."""
    x = np.linspace(0.0, 10.0, 200_001)
    table = Table(table=list(zip(x.tolist(), np.cumsum(np.sin(x * x)).tolist(), strict=True)), lines=True)
    points = _points(table)
    assert _passes(table, points, x[1:-1])
    assert not _passes(table, points, 0.5 * (x[1:] + x[:-1]))


@pytest.mark.parametrize("options", [{"lines": True}, {}, {"akima": True}])
def test_the_effort_of_a_drive_by_a_curve_that_is_not_smooth_has_a_note(options: dict[str, object]) -> None:
    t = np.linspace(0, 2, 101)
    table = Table(table=list(zip(t, AMPLITUDE * np.sin(FREQUENCY * t), strict=True)), **options)
    (note,) = motion_notes(run(shaken(table), duration=2.0))
    assert note.startswith("d: the position by the table 'position' follows")
    assert "'smoothing'" in note


@pytest.mark.parametrize("rate", [100, 1000])
@pytest.mark.parametrize("solver", ["bdf", "kinematic"])
def test_a_smoothing_spline_gives_the_effort_of_a_measured_motion(rate: int, solver: str) -> None:
    """Noise of 0.1 % of the amplitude; inside the record, the effort is within 5 % of that of the true motion."""
    rng = np.random.default_rng(5)
    t = np.linspace(0, 2, 2 * rate + 1)
    points = AMPLITUDE * np.sin(FREQUENCY * t) + 1e-4 * rng.standard_normal(len(t))
    table = Table(table=list(zip(t, points, strict=True)), smoothing=1e-4)
    solution = run(shaken(table), duration=2.0, points=401, solver=solver)
    assert not motion_notes(solution)
    peak = 2.0 * AMPLITUDE * FREQUENCY**2
    inside = (solution.time > 0.2) & (solution.time < 1.8)
    error = solution["d.effort"] + peak * np.sin(FREQUENCY * solution.time)
    assert np.abs(error[inside]).max() < 0.05 * peak


def test_smoothing_keeps_its_distance_and_its_unit() -> None:
    rng = np.random.default_rng(7)
    x = np.sort(rng.uniform(0, 5, 60))
    y = np.cos(x) + 0.02 * rng.standard_normal(60)
    for distance in (0.005, 0.02, 0.1):
        value = curve(Table(table=list(zip(x, y, strict=True)), smoothing=distance))
        assert np.sqrt(np.mean((value(x) - y) ** 2)) == pytest.approx(distance, rel=1e-2)
    with pytest.raises(InputError, match="expected one unit"):
        read_scene(
            PULSE.format(options=", smoothing: 1 s").replace("[0.1, 100]", "[0.1, 100 N], [0.12, 80], [0.15, 50]")
        )
