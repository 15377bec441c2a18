"""Loads of a run: sorted, with peaks, means and bars; over the driving angle; and what a report says of them."""

import json
from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.evaluation.bearing_loads import driving_angle, in_body_axes
from stiffmbs.evaluation.loads import Load, loads, unloaded
from stiffmbs.model.read_scene import read_scene
from stiffmbs.notes import Note, Severity
from stiffmbs.show.finding import finding, note_rows
from stiffmbs.show.loads import Column, load_rows
from stiffmbs.show.sections import differences_section
from stiffmbs.show.verdict import verdict

from ..conftest import EXAMPLES


@pytest.fixture(scope="module")
def crank_slider():
    scene = stiffmbs.load_scene(EXAMPLES / "crank_slider.yaml")
    return scene, stiffmbs.run(scene)


def load_with(values, bar=np.nan, unit="N"):
    time = np.linspace(0.0, 1.0, len(values))
    return Load("pin", unit, time, np.array(values, float).reshape(len(values), -1), bar, True)


def test_loads_are_magnitudes_with_their_instants():
    """At the bottom of its swing a bar lets its pin carry 5/2 of its weight, after a quarter of a swing."""
    solution = stiffmbs.verify(EXAMPLES / "bar_pendulum.yaml", duration=1.0)
    (load,) = loads(solution)
    known = [solution.errors[f"hinge.{part}"] for part in ("fx", "fy")]
    assert load.bar == pytest.approx(np.hypot(*(max(e.over_time, e.least, e.greatest) for e in known)))
    assert load.peak == pytest.approx(2.5 * 1.2 * 9.81, abs=max(load.bar, 1e-3))
    assert load.time[load.peak_row] == pytest.approx(solution.time[np.argmin(solution["bar.y"])], abs=2e-3)
    assert (load.element, load.unit, load.unique, unloaded(solution, [load])) == ("hinge", "N", True, [])


def test_loads_that_are_not_unique_say_so_and_stay():
    unique = {
        (load.element, load.unit): load.unique for load in loads(stiffmbs.run(EXAMPLES / "door.yaml", duration=0.1))
    }
    hinges = [unique[f"{end}_hinge", unit] for end in ("upper", "lower") for unit in ("N", "N m")]
    assert not any(hinges) and unique["closer", "N m"] and ("closer", "N") not in unique


def test_mean_and_root_mean_square_are_over_time_not_over_points():
    load = replace(load_with([[0.0], [4.0], [0.0]]), time=np.array([0.0, 3.0, 4.0]))
    assert load.mean == pytest.approx(2.0) and load.rms == pytest.approx(np.sqrt(8.0)) and load.peak == 4.0


def test_means_have_the_digits_that_the_output_times_resolve():
    """The mean of |sin| over whole periods is 2/pi; few instants know it less well than the peak."""
    for count, places in ((25, 1), (4001, 5)):
        load = load_with(np.sin(np.linspace(0.0, 6.0 * np.pi, count))[:, None] * 10.0, bar=1e-6)
        (row,) = load_rows([load], Column.of("N", 10.0), {})
        assert abs(float(row.mean) - 20 / np.pi) <= 10.0 ** (1 - len(row.mean.partition(".")[2])), row.mean
        assert len(row.mean.partition(".")[2]) <= places and float(row.rms) == pytest.approx(10 / np.sqrt(2), rel=0.02)


def test_torques_of_rounding_are_none():
    """A pendulum about y in space: its hinge carries no torque."""
    scene = {
        "dimensions": 3, "gravity": [0, 0, -9.81],
        "bodies": {"bar": {"mass": 2, "inertia": [0.1, 0.2, 0.25], "position": [0.5, 0, 0]}},
        "joints": {"hinge": {"type": "revolute", "i": {"body": "bar", "point": [-0.5, 0, 0], "orientation": {"z": [0, 1, 0]}},
                             "j": {"body": "ground", "orientation": {"z": [0, 1, 0]}}}},
        "run": {"duration": 0.5, "output": 0.01},
    }  # fmt: skip
    run = stiffmbs.run(read_scene(json.dumps(scene)))
    assert [(load.element, load.unit) for load in loads(run)] == [("hinge", "N")]


BLOW = """
bodies: {b: {mass: 1, inertia: 0.1, position: [1, 0]}}
joints: {d: {type: revolute, i: {body: b, point: [-1, 0]}, j: ground}}
forces: {f: {type: force, i: b, force: [0, '1e4*exp(-((t - 0.513)/1e-3)^2)']}}
run: {duration: 1, output: 0.05}
"""


def test_a_blow_between_output_instants_is_a_load_and_has_its_remedy():
    """It is zero at all output instants; the run knows its peak from its steps."""
    solution = stiffmbs.run(read_scene(BLOW))
    found = loads(solution)
    assert {load.element for load in found} == {"d", "f"} and not unloaded(solution, found)
    further = " ".join(finding(verdict(solution), solution, found).further)
    assert "smaller output interval" in further and "rtol" not in further


def test_loads_without_values_have_no_peak():
    load = load_with([[np.nan], [np.nan]])
    assert load.peak == 0.0 and load.mean == 0.0


def test_the_largest_load_is_first_and_all_have_one_unit(crank_slider):
    found = loads(crank_slider[1])
    forces = [load for load in found if load.unit == "N"]
    assert [load.peak for load in forces] == sorted((load.peak for load in forces), reverse=True)
    assert not unloaded(crank_slider[1], found)
    column = Column.of("N", forces[0].peak)
    assert column.unit == "kN"
    rows = list(load_rows(forces, column, {"ground_pin": "revolute, crank on ground"}))
    assert rows[0].share == 1.0 and float(rows[0].peak) == pytest.approx(forces[0].peak / 1e3, rel=1e-4)
    assert rows[0].about == "revolute, crank on ground"


@pytest.mark.parametrize(
    ("largest", "value", "bar", "unit", "words"),
    [(999.0, 12.0, 0.3, "N", "12.0 ± 0.3"), (1e3, 1234.0, 20.0, "kN", "1.23 ± 0.02"), (2e6, 2e6, np.nan, "MN", "2"),
     (5.0, 5.0, 1e-12, "N", "5.00000 ± 0.00005")],
)  # fmt: skip
def test_a_column_has_one_unit_and_as_many_digits_as_the_bar_allows(largest, value, bar, unit, words):
    column = Column.of("N", largest)
    assert (column.unit, column.words(value, bar)) == (unit, words)


def test_the_driving_angle_is_the_last_revolution_of_a_drive(crank_slider):
    angle = driving_angle(*crank_slider)
    assert angle.joint == "ground_pin" and angle.rows[-1] == len(crank_slider[1].time) - 1
    assert 0 <= angle.sorted_degrees[0] < 2 and 358 < angle.sorted_degrees[-1] < 360
    assert driving_angle(crank_slider[0], stiffmbs.run(crank_slider[0], duration=0.1)) is None  # less than a revolution


def test_loads_rotate_on_a_crank_and_stay_on_the_ground(crank_slider):
    """The thrust on the slider is constant: on the ground its direction stays, on the crank it goes around."""
    scene, solution = crank_slider
    angle = driving_angle(scene, solution)
    load = next(load for load in loads(solution) if load.element == "ground_pin")
    on_crank, on_ground = (vectors[angle.rows] for vectors in in_body_axes(scene, solution, load).values())
    assert np.hypot(*on_crank.T) == pytest.approx(np.hypot(*on_ground.T))
    assert np.ptp(np.arctan2(*on_ground.T[::-1])) < 1.0
    assert np.ptp(np.unwrap(np.arctan2(*on_crank.T[::-1]))) > 6.0


@pytest.mark.parametrize(
    ("notes", "digits", "mark"),
    [((), 3, "Reliable"), ((), 1, "To be checked"), ((), None, "Completed"),
     ((Note("x", severity=Severity.WARNING),), 3, "To be checked"), ((Note("x"),), 3, "Reliable")],
)  # fmt: skip
def test_a_finding_is_reliable_only_with_known_digits_and_without_warnings(crank_slider, notes, digits, mark):
    solution = replace(crank_slider[1], notes=notes)
    judged = replace(verdict(solution), digits={} if digits is None else {"forces": digits})
    found = finding(judged, solution, loads(solution))
    assert found.mark.endswith(mark) and found.status == ("doubt" if mark == "To be checked" else "done")
    assert found.sentence.startswith("The largest force is 5.41") and "kN, in ground_pin at 0.06" in found.sentence


def test_a_run_that_stops_says_so_before_all_else(crank_slider):
    solution = crank_slider[1]
    judged = replace(verdict(solution), status="stopped", headline="0 s to 1 s: singular pose")
    found = finding(judged, solution, loads(solution))
    assert found.mark.endswith("Stopped") and found.sentence == "0 s to 1 s: singular pose."


def test_notes_are_sorted_by_what_they_mean_each_with_what_to_do():
    notes = [
        Note("auto chose radau"),
        Note("peaks lie between; use points: steps", "k", "", "use points: steps", Severity.WARNING),
        Note("the balance is broken", severity=Severity.DOUBT),
    ]
    rows = note_rows(notes)
    assert [row.meaning for row in rows] == ["the result may be wrong", "may affect the result", "changes nothing"]
    assert (rows[1].text, rows[1].remedy) == ("peaks lie between", "use points: steps")
    assert rows[2].remedy == "Nothing to do."


def test_differences_begin_with_what_was_changed_and_the_loads():
    scene = stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml", [("bar_mass", "2.4 kg")])
    runs = [stiffmbs.run(model, duration=0.5) for model in (scene, stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml"))]
    section = differences_section(runs[0], "first", runs[1])
    changed, loads, channels = section.tables
    assert changed.rows == (("parameters.bar_mass", "2.4 kg", "1.2 kg"),)
    assert loads.rows[0][0] == "hinge" and loads.rows[0][3:] == ("+100 %", "N")
    assert channels.heads[0] == "channel" and len(section.drawings) == 3


def test_differences_of_runs_of_different_lengths_state_both():
    scene = stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml")
    long, short = (stiffmbs.run(scene, duration=duration) for duration in (0.5, 0.2))
    section = differences_section(long, "short", short)
    assert "Peaks are those of 0 s to 0.5 s in this run, and of 0 s to 0.2 s in short." in section.sentences
    assert not any("Peaks" in line for line in differences_section(long, "same", long).sentences)
