"""What assembly moves is told by `check` and by a run: every body, the largest moves first, large ones as a problem."""

import math

import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import Body, Fixed, Marker, Model
from stiffmbs.commands.main import main


def held(shifts, turn=0.0):
    """Bodies that fixed joints hold at x = 0, 1, 2 ..., drawn off along y; the first one turned too."""
    model = Model("held")
    for k, shift in enumerate(shifts):
        model.add(f"part{k}", Body(mass=1, inertia=1, position=(k, -shift), angle=0.0 if k else -turn))
        model.add(f"weld{k}", Fixed(i=f"part{k}", j=Marker(body="ground", point=(k, 0))))
    return model


def assembly(messages):
    return [message for message in messages if "assembly changed" in message]


def test_check_names_all_bodies_the_largest_moves_first():
    report = stiffmbs.check(held([0.01, 0.3, 0.002, 0.0, 0.1]))
    (sentence,) = assembly(report.messages)
    assert sentence == (
        "to satisfy the joints at the start, assembly changed part1.y by 0.3 m, part4.y by 0.1 m, part0.y by 0.01 m, "
        "part2.y by 0.002 m"
    )
    assert {move.body: move.distance for move in report.moved} == pytest.approx(
        {"part0": 0.01, "part1": 0.3, "part2": 0.002, "part4": 0.1}
    )
    assert report.sound


def test_a_run_names_the_largest_and_how_many_more():
    (note,) = assembly(stiffmbs.run(held([0.01, 0.3, 0.002, 0.0, 0.1, 0.05]), duration=0.1, points=2).notes)
    assert note.endswith("part1.y by 0.3 m, part4.y by 0.1 m, part5.y by 0.05 m (2 more bodies by less)")


@pytest.mark.parametrize(
    "shifts, turn", [([500.0, 0.0], 0.0), ([0.0, 0.0], math.pi / 2), ([0.0, 0.4], 0.0), ([0.0, 0.0], -1.0)]
)
def test_a_large_move_is_a_problem(shifts, turn):
    report = stiffmbs.check(held(shifts, turn))
    (sentence,) = assembly(report.messages)
    assert not report.sound
    assert "check points of markers, positions and angles" in sentence
    assert f"{math.degrees(turn):.3g} deg" in sentence or not turn


@pytest.mark.parametrize("shifts, turn", [([0.1, 0.0], 0.0), ([0.0, 0.0], 0.5), ([1e-13, 0.0], 1e-13)])
def test_a_correction_of_a_drawing_is_none(shifts, turn):
    report = stiffmbs.check(held(shifts, turn))
    assert report.sound
    assert len(assembly(report.messages)) == (max(*shifts, turn) > 1e-9)


def test_corrections_of_velocities_are_told_by_a_run_alone():
    model = held([0.0])
    model.bodies["part0"] = Body(mass=1, inertia=1, velocity=(0, 2))
    assert not assembly(stiffmbs.check(model).messages)
    assert assembly(stiffmbs.run(model, duration=0.1, points=2).notes)[0].endswith("part0.vy by -2 m/s")


def test_exit_status(tmp_path):
    scene = tmp_path / "far.yaml"
    scene.write_text(
        "bodies: {b: {mass: 1, inertia: 1, markers: {m: {point: [500, 0]}}}}\njoints: {weld: {type: fixed, i: b.m, j: ground}}\n"
    )
    result = CliRunner().invoke(main, ["check", str(scene)])
    assert result.exit_code == 1
    assert "b.x by -500 m" in result.output
    assert CliRunner().invoke(main, ["check", str(scene), "--set", "bodies.b.markers.m.point=[0, 0]"]).exit_code == 0
