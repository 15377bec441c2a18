"""Axles on their rig: against closed forms, left against right, bushings against joints, and what is refused."""

import json
import re

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError, SolverError

ALL = ("bump", "roll", "steer", "lateral", "lateral_parallel", "brake", "traction", "aligning", "aligning_parallel")
NONE = dict.fromkeys(ALL[1:], 0)


def axle(part, word, parameters=None, **sections):
    entry = {"use": part, "compliance": word, "parameters": parameters or {}}
    parts = {"front.left": entry, "front.right": {**entry, "mirror": "y"}}
    found = {"dimensions": 3, "gravity": [0, 0, -9.81], "parts": parts, **sections}
    return json.dumps(found)


def curves(text, **sizes):
    return stiffmbs.kinematics_and_compliance(stiffmbs.read_scene(text), points=7, **{**NONE, **sizes})


@pytest.mark.long
def test_a_trailing_arm_moves_its_wheel_on_a_circle():
    """About a pivot across the car nothing is steered or leans; the rate is that of the spring, and of the weight's arm."""
    pivot, wheel, seat, tower = (0.42, 0.28), (0.0, 0.30), (-0.05, 0.28), (-0.02, 0.66)
    straight = {"pivot_outer": [0.42, 0.66, 0.28], "pivot_inner": [0.42, 0.36, 0.28], "strut_seat": [-0.05, 0.58, 0.28],
                "strut_tower": [-0.02, 0.58, 0.66], "upright_centre": [0, 0.7, 0.3]}  # fmt: skip
    bump = curves(axle("trailing_arm", "rigid", straight), bump=30).sweeps["bump"].channels
    arm = np.subtract(wheel, pivot)
    radius, start = np.hypot(*arm), np.arctan2(arm[1], -arm[0])
    heights = 1e-3 * np.linspace(-30, 30, 7)  # of the wheel, which rolls on its pad
    angle = np.arcsin(np.sin(start) + heights / radius)
    turn = angle - start
    assert bump["left.travel"] == pytest.approx(1e3 * radius * (np.sin(angle) - np.sin(start)), abs=1e-6)
    assert bump["left.longitudinal"] == pytest.approx(1e3 * radius * (np.cos(start) - np.cos(angle)), abs=1e-6)
    for name in ("toe", "camber", "lateral"):
        assert np.max(np.abs(bump[f"left.{name}"])) < 1e-9
    foot = np.subtract(seat, pivot)
    c, s = np.cos(-turn), np.sin(-turn)
    moved = np.stack([pivot[0] + c * foot[0] - s * foot[1], pivot[1] + s * foot[0] + c * foot[1]], axis=1)
    length = np.linalg.norm(np.subtract(tower, moved), axis=1)
    force = 3400 - 25e3 * (length - length[3])  # of the spring, between its stops
    lever = (moved[:, 0] - pivot[0]) * (tower[1] - moved[:, 1]) - (moved[:, 1] - pivot[1]) * (tower[0] - moved[:, 0])
    centre = pivot[0] - radius * np.cos(angle)  # of arm and wheel
    ratio = -lever / length / (pivot[0] - centre)  # over the rise of the wheel
    assert bump["left.motion_ratio.strut.strut"] == pytest.approx(ratio, rel=1e-9)
    assert bump["left.load"] == pytest.approx(force * ratio + 40 * 9.81, rel=1e-9)
    arm_to_front = bump["left.svsa_length"] * np.cos(np.radians(bump["left.svsa_angle"]))
    assert arm_to_front == pytest.approx(-1e3 * (pivot[0] - centre), rel=1e-9), "the pivot lies ahead"


@pytest.mark.long
def test_a_rigid_axle_leans_with_its_wheels():
    """Pads at +-z below wheels 1.48 m apart turn it by asin(z/0.74 m); forces apart cancel, together they move it sideways."""
    scene = {
        "dimensions": 3,
        "gravity": [0, 0, -9.81],
        "parts": {"rear": {"use": "rigid_axle", "compliance": "bushing"}},
    }
    sizes = {**NONE, "bump": 40, "roll": 30, "lateral": 1, "lateral_parallel": 1, "brake": 1}
    found = stiffmbs.kinematics_and_compliance(stiffmbs.read_scene(json.dumps(scene)), "rear", points=5, **sizes)
    assert found.asymmetry() < 1e-9
    lean = np.degrees(np.arcsin(1e-3 * np.linspace(-30, 30, 5) / 0.74))
    roll, together = found.sweeps["roll"].channels, found.sweeps["lateral_parallel"]
    assert roll["left.camber"] == pytest.approx(-lean, abs=1e-9)
    assert roll["right.camber"] == pytest.approx(lean, abs=1e-9)
    assert np.max(np.abs(found.sweeps["lateral"].channels["left.lateral"])) < 1e-9
    assert together.slope("left.lateral") == pytest.approx(-together.slope("right.lateral"), rel=1e-9)
    assert together.slope("left.lateral") > 0.3
    assert found.sweeps["brake"].slope("left.longitudinal") < -0.3, "leaves wind up"
    assert "left.motion_ratio.damper.strut" in found.sweeps["bump"].channels
    assert "left.wheel_rate" not in found.sweeps["brake"].channels


@pytest.mark.long
def test_left_and_right_are_mirror_images_on_bushings():
    found = curves(axle("double_wishbone", "bushing"), lateral=2, lateral_parallel=2, aligning=50, roll=20)
    assert set(found.sweeps) == {"bump", "roll", "lateral", "lateral_parallel", "aligning"}
    assert found.asymmetry() < 1e-9
    lateral = found.sweeps["lateral"]
    assert lateral.slope("left.lateral") > 0.01, "bushings give way outwards"
    assert found.sweeps["bump"].slope("left.camber") < 0, "into the bump the top leans inwards"


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("part", ["double_wishbone", "multi_link", "macpherson", "trailing_arm"])
def test_stiff_bushings_are_joints(part):
    sizes = {"bump": 20, "lateral": 1}
    joints = curves(axle(part, "rigid"), **sizes)
    stiff = {"k_b": 1e9, **({"k_top": 1e8} if part == "macpherson" else {})}
    bushings = curves(axle(part, "bushing", stiff), **sizes)
    for name in ("toe", "camber"):
        for case, bound in (("bump", 2e-3), ("lateral", 5e-3)):
            a, b = (found.sweeps[case].slope(f"left.{name}") for found in (joints, bushings))
            assert abs(a - b) < bound, (case, name)


@pytest.mark.long
def test_the_rack_steers_and_the_bar_adds_to_roll(examples):
    found = stiffmbs.kinematics_and_compliance(
        examples / "car.yaml",
        points=5,
        lateral=2,
        lateral_parallel=2,
        brake=0,
        traction=0,
        aligning=0,
        aligning_parallel=0,
    )
    assert found.asymmetry() < 1e-9
    apart, together = (found.sweeps[name].slope("left.lateral") for name in ("lateral", "lateral_parallel"))
    assert together > apart + 0.001, "both tie rods push the rack's housing the same way"
    assert found.sweeps["steer"].slope("left.toe") < 0 < found.sweeps["steer"].slope("right.toe")
    bump, roll = (found.sweeps[name].channels["left.wheel_rate"][2] for name in ("bump", "roll"))
    assert roll > 1.1 * bump


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"points": 4}, "points: found 4, expected an odd number"),
        ({"points": 5.0}, "points: found 5.0, expected an odd number"),
        ({"bump": "20 mm"}, "bump: found '20 mm', expected a number, zero or more"),
        ({"wheels": "front.left.wheel"}, "wheels: found 'front.left.wheel', expected a list of bodies"),
        ({"axle": "rear"}, r"found no body 'rear\.left\.upright', expected a suspension with one: front\.left, front\.right"),
        ({"swim": 3}, "swim=3: found no such case"),
        ({"body": "hull"}, "found no body 'hull' to clamp"),
        ({"steering": "slide"}, r"found no prismatic or revolute joint 'slide', expected one of front\.left\.hub"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told(arguments, sentence):
    with pytest.raises(InputError, match=sentence):
        stiffmbs.kinematics_and_compliance(stiffmbs.read_scene(axle("double_wishbone", "rigid")), **arguments)


@pytest.mark.long
def test_the_command_writes_table_curves_figure_and_json(tmp_path):
    scene = tmp_path / "axle.yaml"
    scene.write_text(axle("double_wishbone", "bushing"))
    given = ["kc", str(scene), "--points", "5"]
    for case in ALL[1:]:
        given += ["--case", f"{case}=0"]
    curves, figure = tmp_path / "kc.csv", tmp_path / "kc.png"
    shown = CliRunner().invoke(main, [*given, "-o", str(curves), "--figure", str(figure)])
    assert shown.exit_code == 0, shown.output
    assert "camber" in shown.output
    assert len(curves.read_text().splitlines()) == 6
    assert figure.stat().st_size > 1000
    found = json.loads(CliRunner().invoke(main, [*given, "--json"]).output)
    assert found["cases"]["bump"]["values"] == [-50, -25, 0, 25, 50]
    assert found["asymmetry"] < 1e-9
    assert CliRunner().invoke(main, [*given, "--case", "bump=high"]).exit_code == 2


@pytest.mark.long
def test_the_page_names_sides_and_curves():
    """The figure has a legend of left and right, and one in each diagram with several measures; each curve has its color."""
    from stiffmbs.show.suspension import kc_figure

    found = stiffmbs.kinematics_and_compliance(
        stiffmbs.read_scene(axle("double_wishbone", "rigid")), points=5, **{**NONE, "roll": 30}
    )
    page = kc_figure(found)
    (sides,) = page.legends
    assert [text.get_text() for text in sides.get_texts()] == ["left", "right"]
    angles = next(axes for axes in page.axes if axes.get_title().startswith("Support angles"))
    assert [text.get_text() for text in angles.get_legend().get_texts()] == ["brake angle", "drive angle"]
    assert [(line.get_color(), line.get_linestyle()) for line in angles.lines] == [
        ("C0", "-"),
        ("C0", "--"),
        ("C1", "-"),
        ("C1", "--"),
    ]
    camber = next(axes for axes in page.axes if axes.get_title() == "Bump camber")
    assert camber.get_legend() is None


PENDULUM = (
    "gravity: [0, -10]\nbodies: {bar: {mass: 1, inertia: 1, position: [0, -0.5]}}\n"
    "joints: {pin: {type: revolute, i: {body: bar, point: [0, 0.5]}, j: ground}}\n"
    "forces: {motor: {type: torque, i: bar, torque: 4*t}}\nrun: {duration: 1 s, points: 11}\n"
)


@pytest.mark.long
def test_equilibria_over_time_follow_a_torque():
    """A pendulum under a torque of time hangs where its weight balances it."""
    found = stiffmbs.quasi_static(stiffmbs.read_scene(PENDULUM))
    assert found["bar.angle"] == pytest.approx(np.arcsin(4 * found.time / 5), abs=1e-8)
    assert np.max(np.abs(found["bar.omega"])) == 0


@pytest.mark.long
def test_an_instant_without_an_equilibrium_is_told():
    with pytest.raises(SolverError, match=r"t = 1\.4 s: no equilibrium"):
        stiffmbs.quasi_static(stiffmbs.read_scene(PENDULUM), duration=2.0, points=11)


@pytest.mark.long
def test_the_roll_centre_lies_in_the_plane_of_a_body_beside_the_origin(examples):
    """The displacement is measured from the plane y = 0 of the body, not of the ground."""
    scene = stiffmbs.load_scene(examples / "car.yaml", [("bodies.chassis.position", "[0, 0.3, height]")])
    found = json.dumps(stiffmbs.kinematics_and_compliance(scene, points=5, roll=2).as_dict(""))
    values = [float(value) for value in re.findall(r'"axle.roll_centre_lateral": \{"value": ([^,]+),', found)]
    assert values and values == pytest.approx([0.0] * len(values), abs=1e-6)


@pytest.mark.parametrize("names", [("soft", "soft"), ("base", "soft")])
def test_variants_have_different_names(tmp_path, names):
    scene = tmp_path / "axle.yaml"
    scene.write_text(axle("double_wishbone", "rigid"))
    variants = [word for name in names for word in ("--variant", f"{name}=gravity=[0,0,-12]")]
    refused = CliRunner().invoke(main, ["kc", str(scene), *variants])
    assert refused.exit_code == 2 and f"found the name '{names[0]}' twice" in refused.output


@pytest.mark.long
def test_a_page_has_the_curves_of_both_variants(tmp_path):
    pytest.importorskip("jinja2")
    scene = tmp_path / "axle.yaml"
    scene.write_text(axle("double_wishbone", "rigid"))
    given = ["kc", str(scene), "--points", "5"]
    given += [word for name in NONE for word in ("--case", f"{name}=0" if name != "bump" else "bump=30")]
    page = tmp_path / "kc.html"
    refused = CliRunner().invoke(main, [*given, "-o", str(tmp_path / "kc.csv"), "--variant", "heavy=gravity=[0,0,-12]"])
    assert refused.exit_code == 2 and "expected a page" in refused.output
    result = CliRunner().invoke(main, [*given, "-o", str(page), "--variant", "heavy=gravity=[0,0,-12]"])
    assert result.exit_code == 0 and "variant heavy" in result.output, result.output
    compared = [line.split() for line in result.output.partition("\ncompared ")[2].splitlines()]
    assert compared[0] == ["base", "heavy", "change", "unit"]
    assert all(base != heavy for _, base, heavy, *_ in ([row[0], *row[-5:-3]] for row in compared[1:]))
    assert any(row[0] == "load" and row[-3:] == ["+2.0", "%", "N"] for row in compared[1:])
    text = page.read_text()
    assert "<th>base</th><th>heavy</th><th>change</th>" in text and "Bump camber: travel, mm" in text
    assert text.count('class="curve c1') > 3 and 'class="curve c1 other"' in text
    assert CliRunner().invoke(main, [*given, "-o", str(page)]).exit_code == 0
    assert page.read_text().count("<th>axle</th>") == 1  # slopes of both wheels alone have no such column
