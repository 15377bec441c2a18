"""Modes that leave the plane of a plane mechanism are left out by presolve, and by nothing less than a proof."""

import re
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from stiffmbs import register, spatial
from stiffmbs.analyses.check import check
from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.renumber import renumberable
from stiffmbs.analyses.run import run
from stiffmbs.errors import InputError
from stiffmbs.model.read_scene import read_scene
from tests.bench.solvers.flexible_bodies import FLEXIBLE, box, half_car

CRANK = Path(__file__).parents[2] / "examples" / "flexible" / "flexible_slider_crank.yaml"
SHORT = {"duration": 0.02, "output": None, "points": 21, "rtol": 1e-9}


def slider_crank(*changes):
    text = CRANK.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return read_scene(text, file=CRANK)


def left_out(scene, start_from=None):
    solved = _solved(prepare(scene, start_from=start_from))
    return [f"{job.system.bodies[k // 7]}.{'xyz'[k % 7]}" for job in solved for k in job.coordinates.at_rest]


def _solved(job):
    return [subsystem.dynamics for subsystem in job.subsystems] or [job.dynamics]


@pytest.fixture(scope="module")
def arms(tmp_path_factory):
    folder = tmp_path_factory.mktemp("arms")
    box(folder / "arm.vtu", (0, 0.5, 10), (-0.05, 0.05, 2), (-0.03, 0.03, 2))
    return folder


def test_a_rod_bends_in_the_plane_of_its_mechanism_only():
    scene = slider_crank()
    assert left_out(scene) == [f"rod.modes{name}" for name in ("1.y", "2.x", "2.z", "3.x", "3.z")]
    found, expected = (run(scene, **SHORT, presolve=on) for on in (True, False))
    for name in left_out(scene):  # zero in the equations of all modes, too
        assert np.abs(expected[name]).max() < 1e-13
        assert np.abs(found[name]).max() == 0
    assert np.abs(expected["rod.modes1.x"]).max() > 1e-4
    for name in ("rod.modes1.x", "rod.modes2.y", "rod.slider_end.x", "rod.slider_end.y", "slider.x"):
        np.testing.assert_allclose(found[name], expected[name], atol=1e-12)
    assert any(
        "out-of-plane modes that no load excites left out: rod.modes1.y, rod.modes2.x" in line
        for line in check(scene).presolve
    )


@pytest.mark.parametrize(
    "change",
    [
        ("pin: {point: [l1, 0, 0]}", "pin: {point: [l1, 0, 1 um]}"),
        ("inertia: [1e-5, 1e-5, 1e-5]", "inertia: [[1e-5, 0, 0], [0, 1e-5, 1e-9], [0, 1e-9, 1e-5]]"),
        ("name: Flexible slider-crank", "gravity: [0, 0, -1e-6]"),
        ("requests:", "forces: {side: {type: force, i: slider, force: [0, 0, 1e-6]}}\nrequests:"),
        ("requests:", "forces: {side: {type: force, i: {body: slider, point: [0, 0, 1 um]}, force: [1, 0, 0]}}\nrequests:"),
        ("requests:", "forces: {side: {type: torque, i: slider, torque: [0, 1e-6*t, 0]}}\nrequests:"),
        ("requests:", "forces: {side: {type: force, i: slider, axes: body, force: [0, 0, t]}}\nrequests:"),
        ("requests:", "forces: {side: {type: spring_damper, i: slider, j: {body: ground, point: [0, 0, 1]}, stiffness: 1}}\nrequests:"),
        ("requests:", "forces: {side: {type: bushing, i: slider, j: ground, stiffness: [1, 1, 1, 0, 0, 0], preload: [0, 0, 1, 0, 0, 0]}}\nrequests:"),
        ("requests:", "forces: {side: {type: force, i: rod.modes1, force: [0, 100, 0]}}\nrequests:"),
        ("requests:", "forces: {side: {type: spring_damper, i: rod.modes1, j: {body: ground, point: [0, 1, 0]}, stiffness: 1}}\nrequests:"),
        ("requests:", "forces: {side: {type: bushing, i: rod.modes1, j: rod.modes2, stiffness: [1, 1, 1, 0, 0, 0], preload: [0, 1, 0, 0, 0, 0]}}\nrequests:"),
        ("  motor:", "  push: {type: drive, coordinate: rod.modes1.y, position: 1e-5*t}\n  motor:"),
        ("  motor:", "  push: {type: point_on_plane, i: {body: rod.modes1, point: [0, 0, 1]}, j: {body: ground, point: [0, 0, 1]}}\n  motor:"),
        ("requests:", "inputs: {push: 0}\nforces: {side: {type: force, i: rod.slider_end, force: [0, 0, push]}}\nrequests:"),
        ("requests:", "at_start: {bend: {type: drive, coordinate: rod.modes1.y, position: 1e-5}}\nrequests:"),
        ("requests:", "at_start: {bend: {type: drive, coordinate: rod.modes1.y, velocity: 1e-3}}\nrequests:"),
        ("type: revolute, i: rod.crank_end, j: crank.pin", "type: universal, i: {body: rod.crank_end, orientation: {z: [1, 0, 0]}}, j: {body: crank, point: [l1, 0, 0]}"),
    ],
)  # fmt: skip
def test_anything_out_of_the_plane_keeps_all_modes(change):
    assert not left_out(slider_crank(change))


class Sideways(spatial.AppliedForce):
    """Force with a component along z that its fields do not show."""

    kind = "sideways_force"

    @classmethod
    def vector(cls, e, components):
        return super().vector(e, components) + sp.Matrix([0, 0, 1])


def test_an_own_kind_of_force_keeps_all_modes():
    register(Sideways)
    scene = slider_crank(
        ("requests:", "forces: {side: {type: sideways_force, i: rod.slider_end, force: [0, 0, 0]}}\nrequests:")
    )
    assert not left_out(scene)


def test_a_force_on_a_mode_out_of_the_plane_moves_it():
    scene = slider_crank(("requests:", "forces: {side: {type: force, i: rod.modes1, force: [0, 100, 0]}}\nrequests:"))
    found, expected = (run(scene, **SHORT, presolve=on)["rod.modes1.y"] for on in (True, False))
    assert np.abs(expected).max() > 1e-4
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize(
    "change",
    [
        ("requests:", "forces: {load: {type: force, i: slider, force: [-20*vx(slider)*slider.vx, 5*sin(t), 0]}}\nrequests:"),
        ("requests:", "forces: {load: {type: torque, i: rod.slider_end, torque: [0, 0, t]}}\nrequests:"),
        ("requests:", "forces: {load: {type: force, i: {body: slider, orientation: {z: [1, 0, 0]}}, axes: body, force: [0, 0, t]}}\nrequests:"),
        ("requests:", "forces: {load: {type: bushing, i: slider, j: ground, stiffness: [1, 1, 1, 2, 2, 2], preload: [3, 0, 0, 0, 0, 1]}}\nrequests:"),
        ("name: Flexible slider-crank", "gravity: [0, -9.81, 0]"),
    ],
)  # fmt: skip
def test_loads_in_the_plane_excite_no_other_modes(change):
    assert len(left_out(slider_crank(change))) == 5


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (("  motor:", "  rod.modes1_axes: {type: point_on_plane, i: slider, j: ground}\n  motor:"), "joints.rod.modes1_axes"),
        (("  slider:\n", "  rod.modes1: {mass: 1, inertia: [1, 1, 1]}\n  slider:\n"), "bodies.rod.modes1"),
    ],
)  # fmt: skip
def test_names_of_its_parts_are_taken(change, named):
    with pytest.raises(InputError, match=f"{named}: found the name of a part of the flexible body rod"):
        slider_crank(change)


@pytest.mark.parametrize("presolve", [True, False])
def test_a_continued_run_leaves_out_the_same_modes(presolve):
    scene = slider_crank()
    first = run(scene, **SHORT, presolve=presolve)
    assert len(left_out(scene, start_from=first)) == 5
    found, expected = (run(scene, **SHORT, start_from=first, presolve=on) for on in (True, False))
    assert abs(first["rod.modes1.x"][-1]) > 1e-5
    for name in ("rod.modes1.x", "rod.modes1.y", "rod.modes2.x", "rod.modes2.y", "rod.slider_end.z", "slider.x"):
        np.testing.assert_allclose(found[name], expected[name], atol=1e-10)
    for name in left_out(scene):  # where the first run left rounding, too
        assert not found[name].any()


def test_later_stages_leave_out_the_same_modes_until_a_load_excites_them():
    step = "run: {duration: 10 ms, output: 1 ms}"
    stages = f"stages: [{{{step}}}, {{{step}}}, {{change: {{gravity: [0, 0, -9.81]}}, {step}}}]"
    scene = slider_crank(("requests:", f"{stages}\nrequests:"))
    found, expected = (run(scene, rtol=1e-9, presolve=on) for on in (True, False))
    assert {"runs 1, 2: 206 unknowns reduced to 95", "run 3: 206 unknowns reduced to 105"} < set(found.presolve)
    assert np.abs(expected["rod.modes1.y"]).max() > 1e-6
    for name in ("rod.modes1.x", "rod.modes1.y", "rod.modes2.x", "rod.modes2.y", "slider.x"):
        np.testing.assert_allclose(found[name], expected[name], atol=1e-10)


def test_a_deformed_equilibrium_leaves_out_the_same_modes(arms):
    path = arms / "half_car.yaml"
    half_car(arms, FLEXIBLE)
    text = path.read_text().replace("200e3*(0.3 - dz(front", "(200e3 + 1e4*sin(20*t))*(0.3 - dz(front")
    scene = read_scene(text + "start: equilibrium\n", file=path)
    assert len(left_out(scene)) == 20
    found, expected = (run(scene, duration=0.2, rtol=1e-10, solver="radau", presolve=on) for on in (True, False))
    assert abs(expected["front.modes1.x"][0]) > 1e-5
    for name in ("chassis.z", "rear.seat.x", *(f"front.modes{k}.{x}" for k in (1, 2, 3) for x in "xyz")):
        np.testing.assert_allclose(found[name], expected[name], atol=1e-10)


def test_half_of_the_modes_of_a_half_car_are_left_out(arms):
    scene = half_car(arms, FLEXIBLE)
    names = left_out(scene)
    assert len(names) == 20
    found, expected = (run(scene, duration=0.2, rtol=1e-10, solver="radau", presolve=on) for on in (True, False))
    for name in ("chassis.z", "front.wheel.z", "rear.seat.x", *(f"front.modes{k}.{x}" for k in (1, 2) for x in "xyz")):
        np.testing.assert_allclose(found[name], expected[name], atol=1e-11)
    assert max(np.abs(expected[name]).max() for name in names) < 1e-15


def test_a_load_from_the_side_bends_the_arms_of_a_half_car(arms):
    tyre = "front_tyre: {type: force, i: front.wheel, force: [0, "
    path = arms / "half_car.yaml"
    half_car(arms, FLEXIBLE)
    text = path.read_text()
    assert tyre + "0," in text
    scene = read_scene(text.replace(tyre + "0,", tyre + "10*t,"), file=path)
    assert not left_out(scene)


def test_other_numbers_are_not_written_into_a_job_without_some_modes(arms):
    job = prepare(half_car(arms, FLEXIBLE))
    assert not renumberable(job)


def test_a_turned_mechanism_leaves_out_as_many_modes():
    text = CRANK.read_text()
    turned = re.sub(r"\[0, 0, (-?rate[^\]]*)\]", r"[0, -(\1), 0]", text)
    assert turned != text
    turned = turned.replace("velocity: [0, rate*l1/2, 0]", "velocity: [0, 0, rate*l1/2]")
    turned = turned.replace("type: revolute, i: crank, j: ground", "type: revolute, i: {body: crank, orientation: {z: [0, -1, 0]}}, j: {body: ground, orientation: {z: [0, -1, 0]}}")  # fmt: skip
    turned = turned.replace("i: rod.crank_end, j: crank.pin", "i: {body: rod.crank_end, orientation: {z: [0, -1, 0]}}, j: {body: crank, point: [l1, 0, 0], orientation: {z: [0, -1, 0]}}")  # fmt: skip
    turned = turned.replace("wrist_pin: {type: point_on_line, i: rod.slider_end, j: slider}", "wrist_pin: {type: point_on_line, i: rod.slider_end, j: {body: slider, orientation: {z: [0, -1, 0]}}}")  # fmt: skip
    turned = turned.replace("rod_angle: atan2(rod.slider_end.y - rod.crank_end.y, ", "rod_angle: atan2(rod.slider_end.z - rod.crank_end.z, ")  # fmt: skip
    scene = read_scene(turned, file=CRANK)
    assert len(left_out(scene)) == 5
    np.testing.assert_allclose(run(scene, **SHORT)["slider.x"], run(slider_crank(), **SHORT)["slider.x"], atol=1e-10)
