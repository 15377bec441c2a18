"""A mount drawn off its place is reported by check and run, with its force, deflection and remedy; others are not."""

from __future__ import annotations

import re

import pytest

import stiffmbs
from stiffmbs import read_scene, run
from stiffmbs.equilibria import equilibrium
from tests.conftest import EXAMPLES

LEVER = """
gravity: [0, -9.81]
bodies:
  lever: {{mass: 1 kg, inertia: 0.01, position: [0.1, {off}], markers: {{foot: {{point: [-0.1, 0]}}}}}}
forces:
  mount: {{type: {mount}}}
run: {{duration: 0.01, output: 1 ms}}
"""
BUSHING = "bushing, i: lever.foot, j: ground, stiffness: [5e7, 5e7, 1e3], damping: [1e3, 1e3, 1]"
IN_SPACE = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies: {hub: {mass: 8, inertia: [0.1, 0.1, 0.1], position: [0, 0.005, 0]}}
forces: {mount: {type: bushing, i: hub, j: ground, stiffness: [1e8, 1e8, 1e8, 1e4, 1e4, 1e4]}}
run: {duration: 0.001}
"""
PRESS = """
gravity: [0, -9.81]
bodies:
  crank: {mass: 6 kg, inertia: 0.02, omega: 60 rpm, markers: {pin: {point: [80 mm, 0]}}}
  coupler: {mass: 5 kg, inertia: 0.07, position: [280 mm, 0], markers: {a: {point: [-200 mm, 0]}, b: {point: [200 mm, 0]}}}
  rocker: {mass: 8 kg, inertia: 0.05, position: [400 mm, -75 mm], angle: 80 deg, markers: {foot: {point: [-125 mm, 0]}, head: {point: [125 mm, 0]}}}
joints:
  main_bearing: {type: revolute, i: crank, j: ground}
  crank_pin: {type: revolute, i: coupler.a, j: crank.pin}
  knee: {type: revolute, i: coupler.b, j: rocker.head}
  motor: {type: drive, joint: main_bearing, velocity: 60 rpm}
forces:
  foot: {type: bushing, i: rocker.foot, j: {body: ground, point: [350 mm, -150 mm]}, stiffness: [5e7, 5e7, 0], damping: [2e4, 2e4, 0]}
run: {duration: 0.002, points: 3}
"""


def lever(off: float, mount: str = BUSHING) -> stiffmbs.Scene:
    return read_scene(LEVER.format(off=off, mount=mount))


def starts(sentences: object) -> list[str]:
    return [sentence for sentence in sentences if "starts with" in sentence]  # type: ignore[attr-defined]


@pytest.mark.parametrize("off", [0.02, -0.02, 0.0005])
def test_a_mount_off_its_place_is_named_by_check_and_run(off: float) -> None:
    """k d = 5e7 N/m times the offset, against the weight of 9.81 N in equilibrium."""
    (note,) = starts(run(lever(off)).notes)
    assert f"'mount' starts with {5e7 * abs(off):.3g} N, deflected by {1e3 * abs(off):.3g} mm" in note
    assert f"{0.5 * 5e7 * off**2:.3g} J" in note
    assert "in the static equilibrium it carries 9.81 N" in note
    assert "start: settled" in note
    assert starts(stiffmbs.check(lever(off)).messages) == [note]


def test_a_mount_in_its_place_or_settled_has_no_note() -> None:
    assert not starts(run(lever(0.0)).notes)
    assert not starts(run(lever(-1e-7)).notes)
    settled = lever(0.02).model_copy(update={"start": "settled"})
    assert not starts(run(settled).notes)
    assert not starts(run(lever(0.02), start_from=run(settled)).notes)


STAGES = """
gravity: [0, -9.81]
START
bodies: {b: {mass: 1, inertia: 0.01, position: [0.1, 0]}}
joints: {f: {type: fixed, i: {body: b, point: [-0.1, 0]}, j: ground}}
run: {duration: 0.01, points: 3}
stages:
- {run: {duration: 0.01}}
- change: {joints: {f: null}, forces: {m: {type: bushing, i: {body: b, point: [-0.1, 0]}, j: {body: ground, point: [0, OFF]}, stiffness: [5e7, 5e7, 1e3], damping: [1e3, 1e3, 1]}}}
- {run: {duration: 0.01}}
"""


@pytest.mark.parametrize("start", ["", "start: settled"])
def test_a_mount_that_a_stage_adds_off_its_place_is_named(start: str) -> None:
    """1e6 N by 20 mm; `check` had the note, the run none. The stage after it, which adds nothing, has none."""
    (note,) = starts(run(read_scene(STAGES.replace("START", start).replace("OFF", "0.02"))).notes)
    assert note.startswith("run 2: 'm' starts with 1e+06 N, deflected by 20 mm")
    assert "analysis: static" in note
    assert not starts(run(read_scene(STAGES.replace("START", start).replace("OFF", "0"))).notes)


@pytest.mark.parametrize(("omega", "noted"), [(0.0, True), (20.0, False)])
def test_a_mount_between_bodies_of_different_velocities(omega: float, noted: bool) -> None:
    """The end of the lever moves at 2 m/s: 1e3 N s/m damp it with 2 kN."""
    scene = read_scene(
        LEVER.format(off=0, mount=BUSHING), [("bodies.lever.velocity", [0, 2]), ("bodies.lever.omega", omega)]
    )
    for notes in (run(scene).notes, stiffmbs.check(scene).messages):
        found = starts(notes)
        assert len(found) == noted
        assert not noted or "'mount' starts with 2e+03 N of its damping" in found[0]


@pytest.mark.long
def test_a_mount_in_space() -> None:
    (note,) = starts(run(read_scene(IN_SPACE)).notes)
    assert "'mount' starts with 5e+05 N, deflected by 5 mm" in note


def test_assembly_that_opens_a_mount_is_named() -> None:
    (note,) = starts(stiffmbs.check(read_scene(PRESS)).messages)
    assert "'foot' starts with 6.15e+06 N, deflected by 123 mm" in note
    assert "assembly considers joints only, and has stretched it by 67.2 mm" in note


def test_without_an_equilibrium_the_weight_decides(monkeypatch: pytest.MonkeyPatch) -> None:
    """The search for one ends soon: only a note depends on it, and half a minute passed for a single body."""
    moves, moved_on = [], equilibrium.moved_on
    monkeypatch.setattr(equilibrium, "moved_on", lambda *args: moves.append(1) or moved_on(*args))
    pushed = LEVER.replace("forces:", "forces:\n  push: {{type: force, i: lever, force: [0, -20]}}")
    free = "spring_damper, i: lever.foot, j: {{body: ground, point: [0, -1]}}, stiffness: 1e7, free_length: {length}"
    (note,) = starts(run(read_scene(pushed.format(off=0, mount=free.format(length=0.98)))).notes)
    assert "'mount' starts with 2e+05 N" in note
    assert 50 < len(moves) < 150


@pytest.mark.parametrize(
    "mount",
    [
        "spring_damper, i: lever.foot, j: {body: ground, point: [0, -1]}, stiffness: 1e4, free_length: 0.7",
        "bushing, i: lever.foot, j: ground, stiffness: [300, 300, 3], damping: [1, 1, 0]",
        "bushing, i: lever.foot, j: ground, stiffness: [5e7, 5e7, 1e3], preload: [0, 9.81, 0]",
        "force, i: lever, force: [0, 2e5]",
    ],
)
def test_springs_stretched_on_purpose_and_applied_forces_have_no_note(mount: str) -> None:
    """A spring of 3000 N throws a lever of 1 kg; the offset of a soft bushing is 20 mm, and that of the preloaded one zero."""
    off = 0.02 if "300, 300" in mount else 0.0
    assert not starts(run(lever(off, mount), duration=1e-3).notes)


def test_a_rotor_in_its_bearing_has_the_deflection_of_its_motion() -> None:
    """A ring mass of 1 kg at 0.1 m turns at 2000 rad/s about a bushing that is deflected by what it carries: 4e5 N."""
    scene = """
bodies: {rotor: {mass: 1, inertia: 0.01, position: [0.104, 0], velocity: [0, 208], omega: 2000}}
forces: {bearing: {type: bushing, i: {body: rotor, point: [-0.1, 0]}, j: ground, stiffness: [1.04e8, 1.04e8, 0]}}
run: {duration: 1e-4}
"""
    assert not starts(run(read_scene(scene)).notes)


@pytest.mark.parametrize(
    "name", ["elastic_bearing", "half_car", "door", "governor", "cam_follower", "vehicles/quarter_car"]
)
def test_examples_start_without_a_note(name: str) -> None:
    assert not starts(stiffmbs.check(stiffmbs.load_scene(EXAMPLES / f"{name}.yaml")).messages)


OFF_ITS_PLACE = """
dimensions: 3
bodies:
  block: {mass: 3, inertia: [0.01, 0.01, 0.01], position: [0.51, 0, 0]}
forces:
  strut: {type: beam, i: block, j: ground, length: 0.5, young: 210 GPa, shear_modulus: 80 GPa, area: 3e-4, torsion: 1e-8, iyy: 5e-9, izz: 5e-9}
run: {duration: 0.001, points: 3}
"""
TOO_FAR_APART = """
bodies:
  rod: {type: beam, start: [0, 0], end: [1, 0], elements: 4, interpolation: INTERPOLATION, stiffness: [6e7, 2e7, 2e3], mass_per_length: 2.4, inertia_per_length: 6e-5}
joints:
  left: {type: revolute, i: rod.start, j: ground}
  right: {type: revolute, i: rod.end, j: {body: ground, point: [1.02, 0]}}
run: {duration: 1e-4, points: 3}
"""


def test_a_beam_force_of_two_bodies_off_its_place() -> None:
    """E A/L = 1.26e8 N/m times 10 mm."""
    (note,) = starts(stiffmbs.check(read_scene(OFF_ITS_PLACE)).messages)
    assert "'strut' starts with 1.26e+06 N, deflected by 10 mm, with 6.3e+03 J" in note


@pytest.mark.parametrize("interpolation", ["pairs", "spectral"])
def test_beams_that_joints_stretch(interpolation: str) -> None:
    """All of the 20 mm are in the last interval; sections carry at least E A times the mean strain of 2 %."""
    (note,) = starts(stiffmbs.check(read_scene(TOO_FAR_APART.replace("INTERPOLATION", interpolation))).messages)
    found = re.match(r"'rod\.element4' starts with (\S+) N, deflected by (\S+) mm", note)
    assert found and float(found[1]) > 0.02 * 6e7
    assert float(found[2]) == pytest.approx(20, rel=0.2)
    assert "assembly considers joints only, and has stretched it by" in note


def test_deflections_of_powers_and_of_other_forces() -> None:
    """k d^n has the energy F d/(n + 1); force and energy of a law or with a preload do not determine the deflection."""
    contact = "contact, i: lever.foot, j: {body: ground, point: [0, 0.02]}, radius: 0.03, stiffness: 1e8, exponent: 1.5"
    (note,) = starts(stiffmbs.check(lever(0.03, contact)).messages)
    assert f"{1e8 * 0.02**1.5:.3g} N, deflected by 20 mm, with" in note
    (note,) = starts(stiffmbs.check(lever(0.02, BUSHING + ", preload: [0, 1e5, 0]")).messages)
    assert "starts with 9e+05 N, with 8e+03 J" in note
    law = "spring_damper, i: lever, j: ground, spring_law: {table: [[0, 0], [0.1, 1e4], [0.2, 1e6]]}"
    (note,) = starts(stiffmbs.check(lever(0.0, law)).messages)
    assert "deflected" not in note


WELDED = """
gravity: [0, -9.81]
bodies:
  bob: {mass: 1, inertia: 0.1, position: [0, -1]}
  box: {mass: 1, inertia: 0.1, position: [1.5, -1]}
joints:
  weld: {type: fixed, i: box, j: bob}
  hinge: {type: revolute, i: {body: bob, point: [0, 1]}, j: ground}
run: {duration: 0.01, points: 3}
"""


@pytest.mark.parametrize("start", ["described", "settled", "equilibrium"])
def test_bodies_that_assembly_moves_far_are_named_from_any_start(start: str) -> None:
    """A weld without its points pulls the box by 1.1 m; a start in an equilibrium had no note on it."""
    found = run(read_scene(WELDED + f"start: {start}"))
    (note,) = [each for each in found.notes if "assembly changed" in each]
    assert "box moves by more than 0.25 of the mechanism's size" in note
    assert "assembly" not in str(run(read_scene(WELDED.replace("[1.5, -1]", "[0, -1]") + f"start: {start}")).notes)


def test_bodies_that_assembly_moves_far_are_named_in_steady_motion() -> None:
    """The sled keeps 3 m/s, at which drive and drag balance."""
    scene = """
    bodies: {sled: {mass: 2, inertia: 1, velocity: [3, 0]}, load: {mass: 1, inertia: 1, position: [9, 0], velocity: [3, 0]}}
    joints: {rail: {type: prismatic, i: sled, j: ground}, weld: {type: fixed, i: load, j: sled}}
    forces: {drag: {type: force, i: sled, force: ["6 N - 2*vx(sled)", 0]}}
    start: {velocity: [3, 0], speed: found}
    run: {duration: 0.01, points: 3}
    """
    found = run(read_scene(scene))
    assert found["sled.vx"] == pytest.approx(3)
    assert any("assembly changed" in note and "mechanism's size" in note for note in found.notes)
    assert not any("assembly" in note for note in run(read_scene(scene.replace("[9, 0]", "[0, 0]"))).notes)


@pytest.mark.parametrize("given", [3.0, 2.5, 8.0])
def test_a_speed_that_forces_determine_far_from_the_described_one_has_a_note(given: float) -> None:
    scene = f"""
    bodies: {{sled: {{mass: 2, inertia: 1, velocity: [{given}, 0]}}}}
    joints: {{rail: {{type: prismatic, i: sled, j: ground}}}}
    forces: {{drag: {{type: force, i: sled, force: ["6 N - 2*vx(sled)", 0]}}}}
    start: {{velocity: [{given}, 0], speed: found}}
    run: {{duration: 0.01, points: 3}}
    """
    found = run(read_scene(scene))
    assert found["sled.vx"] == pytest.approx(3)
    noted = any("a steady motion of 3 m/s; the velocity of start is 8 m/s" in note for note in found.notes)
    assert noted == (given == 8.0)


@pytest.mark.parametrize("start", ["described", "settled", "equilibrium"])
@pytest.mark.parametrize(("apart", "noted"), [(1.02, True), (1.0, False)])
def test_a_beam_between_joints_that_do_not_fit_has_a_note_from_any_start(start: str, apart: float, noted: bool) -> None:
    """It keeps E A / L times 20 mm in the equilibrium, where nothing moves."""
    scene = f"""
    dimensions: 3
    gravity: [0, 0, -9.81]
    bodies:
      rod: {{type: beam, start: [0, 0, 0], end: [1, 0, 0], elements: 4, section: {{type: circle, diameter: 20 mm}}, material: {{E: 210 GPa, nu: 0.3, density: 7800 kg/m^3}}}}
    joints:
      a: {{type: fixed, i: rod.start, j: ground}}
      b: {{type: spherical, i: rod.end, j: {{body: ground, point: [{apart}, 0, 0]}}}}
    start: {start}
    run: {{duration: 1 ms, points: 2}}
    """
    found = [note for note in run(read_scene(scene)).notes if "starts with" in note]
    assert bool(found) == noted
    assert all(
        "in the static equilibrium it carries 1.3" in note and "pose that does not fit" in note for note in found
    )
