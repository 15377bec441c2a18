"""Runs from a saved state: as if they had never been interrupted; at rest from an equilibrium; refusals in a sentence."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main

from ..conftest import EXAMPLES

WOUND = """
dimensions: 3
bodies:
  disc: {mass: 2, inertia: [[0.02, 0.001, 0.002], [0.001, 0.03, 0.003], [0.002, 0.003, 0.04]], omega: [0, 0, 16]}
joints:
  axle: {type: revolute, i: disc, j: ground}
forces:
  spring: {type: torsion_spring, i: disc, j: ground, stiffness: 0.05, damping: 0.001}
"""
"""A disc that turns by several turns against a spring: where it goes back from there, its count of turns tells."""


def _scene(name):
    return stiffmbs.read_scene(WOUND) if name == "wound" else stiffmbs.load_scene(EXAMPLES / f"{name}.yaml")


@pytest.mark.parametrize("name", ["cart_pendulum", "crank_slider", "heavy_top", "governor", "wound"])
def test_an_interrupted_run_goes_on_as_if_it_were_none(name, tmp_path):
    scene = _scene(name)
    whole = stiffmbs.run(scene, duration=2.0, points=21, rtol=1e-10)
    first = stiffmbs.run(scene, duration=1.0, points=11, rtol=1e-10)
    first.save(tmp_path / "first.npz")
    second = stiffmbs.run(scene, start_from=tmp_path / "first.npz", duration=1.0, points=11, rtol=1e-10)
    assert second.time[0] == 1.0 and second.time[-1] == 2.0
    assert not [note for note in second.notes if "assembly changed" in note]
    for channel in whole:
        if not channel.startswith(("constraint.", "energy.")):
            scale = 1 + np.abs(whole[channel]).max()
            assert np.allclose(whole[channel][10:], second[channel], rtol=0, atol=2e-6 * scale), channel
            assert abs(second[channel][0] - first[channel][-1]) < 1e-8 * scale, channel


def test_the_spring_that_is_wound_keeps_its_turns():
    first = stiffmbs.run(_scene("wound"), duration=1.0, rtol=1e-9)
    again = stiffmbs.run(_scene("wound"), start_from=first, duration=0.1)
    assert abs(first["spring.tz"][-1]) > 0.05 * 3 * np.pi  # half a turn is what a pose tells
    assert again["spring.tz"][0] == pytest.approx(first["spring.tz"][-1], rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("ending", ["csv", "nc", "npz"])
def test_any_file_of_results_and_any_row(ending, tmp_path):
    if ending == "nc":
        pytest.importorskip("xarray")
    scene = _scene("governor")
    whole = stiffmbs.run(scene, duration=1.0, points=11, rtol=1e-9)
    file = tmp_path / f"results.{ending}"
    whole.save(file)
    again = stiffmbs.run(scene, start_from=stiffmbs.read_state(file, at=0.3), duration=0.2, points=3, rtol=1e-9)
    assert again.time == pytest.approx([0.3, 0.4, 0.5])
    for channel in ("arm_1.x", "arm_1.q0", "arm_1.wx", "sleeve.vz"):
        if channel in whole:
            assert again[channel] == pytest.approx(whole[channel][3:6], abs=1e-6)


def test_the_time_at_the_start_is_that_of_the_state_unless_told():
    scene = _scene("cart_pendulum")
    first = stiffmbs.run(scene, duration=1.0)
    assert stiffmbs.run(scene, start_from=first, start=0, duration=0.5).time[0] == 0.0
    assert stiffmbs.run(scene, start_from=first.state(at=0.5), duration=0.5).time[0] == 0.5


@pytest.mark.long
def test_an_equilibrium_on_the_command_line_is_where_a_run_stays_at_rest(tmp_path):
    scene = str(EXAMPLES / "half_car.yaml")
    state, results = str(tmp_path / "state.npz"), str(tmp_path / "results.npz")
    told = CliRunner().invoke(main, ["equilibrium", scene, "-o", state, "--json"])
    assert told.exit_code == 0
    poses = json.loads(told.stdout)["channels"]
    done = CliRunner().invoke(
        main, ["run", scene, "--from", state, "--set", "V=1e-9", "--rtol", "1e-9", "--duration", "10", "-o", results]
    )
    assert done.exit_code == 0, done.output
    found = stiffmbs.Solution.load(results)
    for channel in ("chassis.x", "chassis.y", "chassis.angle", "front.y", "rear.y"):
        assert np.abs(found[channel] - poses[channel]).max() < 1e-8


def test_modes_about_a_saved_equilibrium():
    scene = _scene("half_car")
    rest = stiffmbs.equilibrium(scene)
    found = stiffmbs.modes(scene, start_from=rest.solution)
    assert not [note for note in found.notes if "no equilibrium" in note]


WRONG = [
    (["--from", "{cart}"], "found bodies of the plane, expected those of a scene in space"),
    (["--from", "{other}"], "found no state of body 'top', expected the bodies of the scene; it has 'spin'"),
    (
        ["--from", "{top}", "--at", "0.123"],
        "found no row at t = 0.123 s, expected an instant that was saved: there are 3",
    ),
    (["--from", "missing.npz"], "missing.npz: No such file or directory, expected a file that stiffmbs run -o wrote"),
    (["--from", "{text}"], "text.npz: found no table of channels, expected a file that stiffmbs run -o wrote"),
    (["--from", "{ending}"], "found the ending '.yaml', expected one of .npz, .csv, .nc"),
    (["--at", "1"], "--at 1: found no file to take a row of, expected --from FILE too"),
]


@pytest.mark.parametrize("options, told", WRONG, ids=[told[:30] for _, told in WRONG])
def test_what_is_no_state_of_the_scene_is_refused(options, told, tmp_path):
    files = {name: tmp_path / f"{name}.npz" for name in ("cart", "top", "other", "text")}
    stiffmbs.run(_scene("cart_pendulum"), duration=0.1, points=3).save(files["cart"])
    stiffmbs.run(_scene("heavy_top"), duration=0.1, points=3).save(files["top"])
    other = "dimensions: 3\nbodies: {spin: {mass: 1, inertia: [1, 1, 1]}}"
    stiffmbs.run(stiffmbs.read_scene(other), duration=0.1, points=3).save(files["other"])
    files["text"].write_text("time, bar.x\n")
    files["ending"] = EXAMPLES / "heavy_top.yaml"
    options = [option.format(**files) for option in options]
    done = CliRunner().invoke(main, ["run", str(EXAMPLES / "heavy_top.yaml"), *options, "--json"])
    assert done.exit_code == 2 and told in json.loads(done.stdout)["message"]


def test_bodies_that_the_scene_does_not_have_are_refused():
    two = "bodies: {one: {mass: 1, inertia: 1}, other: {mass: 1, inertia: 1}}"
    found = stiffmbs.run(stiffmbs.read_scene(two), duration=0.1)
    one = stiffmbs.read_scene("bodies: {one: {mass: 1, inertia: 1}}")
    with pytest.raises(stiffmbs.InputError, match="found body 'other', which the scene does not have"):
        stiffmbs.run(one, start_from=found, duration=0.1)
