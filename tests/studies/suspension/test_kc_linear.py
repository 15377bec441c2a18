"""Measures and compliance matrices of every axle template against rigid bodies with small motions, at random hard points of either side."""

import json
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

import stiffmbs

from .linear_axle import SIGN, Linear, compliance, corner, leaf, measures, turned_to, twist_beam, wheel_of

CORNERS = {
    "double_wishbone": "lower_front lower_rear lower_ball upper_front upper_rear upper_ball tie_inner tie_outer strut_seat strut_tower",
    "macpherson": "lower_front lower_rear lower_ball tie_inner tie_outer strut_seat strut_tower",
    "multi_link": "lower_front_inner lower_front_outer lower_rear_inner lower_rear_outer upper_front_inner upper_front_outer "
    "upper_rear_inner upper_rear_outer toe_inner toe_outer strut_seat strut_tower",
    "pushrod_wishbone": "lower_front lower_rear lower_ball upper_front upper_rear upper_ball tie_inner tie_outer pushrod_outer pushrod_inner "
    "rocker_pivot strut_seat strut_tower",
    "trailing_arm": "pivot_outer pivot_inner strut_seat strut_tower",
}  # fmt: skip
WHEELBASE, HEIGHT = 2.6, 0.55


SHIPPED = Path(stiffmbs.__file__).parent / "model" / "shipped_parts"
CENTRES = {"pushrod_wishbone": (0, 0.60, 0.23), "rigid_axle": (0, 0.74, 0.34), "twist_beam": (0, 0.74, 0.30)}


def drawn(part, names, rng):
    """Points of a part, each moved at random from that of its file, and the angles of the wheel."""
    own = YAML(typ="safe").load((SHIPPED / f"{part}.yaml").read_text())["parameters"]
    points = {name: [float(str(x).removesuffix(" m")) for x in own[name]] for name in names.split()}
    points["wheel_centre"] = CENTRES.get(part, (0, 0.76, 0.30))
    moved = {name: np.array(point) + rng.uniform(-0.02, 0.02, 3) for name, point in points.items()}
    return moved, dict(zip(("toe", "camber"), np.radians(rng.uniform(-2, 2, 2)), strict=True))


def kc(parts, axle, **cases):
    bodies = {
        "other": {
            "mass": 1,
            "inertia": [1, 1, 1],
            "markers": {"patch": {"point": [-WHEELBASE if axle == "front" else WHEELBASE, 0, 0]}},
        }
    }
    scene = {"dimensions": 3, "gravity": [0, 0, 0], "bodies": bodies, "joints": {"held": {"type": "fixed", "i": "other", "j": "ground"}}, "parts": parts}  # fmt: skip
    sizes = dict.fromkeys(("bump", "roll", "steer", "lateral", "lateral_parallel", "brake", "traction", "aligning", "aligning_parallel"), 0) | cases  # fmt: skip
    vehicle = stiffmbs.VehicleOptions(wheelbase=WHEELBASE, cg_height=HEIGHT, brake_share=0.6, drive_share=0.7)
    return stiffmbs.kinematics_and_compliance(
        stiffmbs.read_scene(json.dumps(scene)), axle, points=5, vehicle=vehicle, **sizes
    )


def compare(found, expected, tolerance):
    missing = [name for name in expected if name not in found.measures]
    assert not missing
    for name, value in expected.items():
        if not np.isfinite(value) or abs(value) > 1e6:
            continue
        scale = 100 if "roll_centre" in name or name.endswith("length") else 1
        assert found.measures[name] == pytest.approx(value, rel=tolerance, abs=tolerance * scale), name


@pytest.mark.sampled(9)
@pytest.mark.long
@pytest.mark.parametrize("rigid", [True, False], ids=["rigid", "bushing"])
@pytest.mark.parametrize("part", CORNERS)
@pytest.mark.parametrize("axle", ["front", "rear"])
def test_corners(part, axle, rigid):
    rng = np.random.default_rng([*part.encode(), axle == "front", rigid])
    m, wheels, springs, parts = Linear(), [], [], {}
    steers, k_b = part != "trailing_arm", rng.uniform(5e6, 2e7)
    rack, row, middle = (m.body("rack") if steers else None), None, np.array([0.1, 0, 0.28])
    if steers:
        parts["steering"] = {"use": "steering_rack", "compliance": "rigid" if rigid else "bushing", "parameters": {"centre": middle.tolist()}}  # fmt: skip
    for side in ("left", "right"):
        points, angles = drawn(part, CORNERS[part], rng)
        own = {name: p * [1, SIGN[side], 1] for name, p in points.items()}
        if part == "pushrod_wishbone":
            own["rocker_axis"] = np.array([1.0, 0, 0])
        k = rng.uniform(15e3, 60e3)
        upright = corner(m, part, side, own, rack, rigid, k_b, k)
        springs.append({"strut.strut": m.springs[-1][0]})
        wheels.append(wheel_of(side, upright, own["wheel_centre"], **angles))
        given = {**{name: p.tolist() for name, p in points.items()}, **angles, "spring": k, "strut_load": 0, "k_b": k_b}
        parts[f"{axle}.{side}"] = {"use": part, "parameters": given, "compliance": "rigid" if rigid else "bushing"}
        if steers:
            parts[f"{axle}.{side}"]["mounts"] = {"rack": "steering.rack"}
    parts[f"{axle}.right"]["mirror"] = "y"
    if steers:
        housing = None
        if not rigid:
            housing = m.body("housing")
            for y in (0.3, -0.3):
                m.bushing(
                    housing, None, middle + np.array([0, y, 0]), turned_to([0, 1, 0]), [5e6, 5e6, 2.5e6, 500, 500, 500]
                )
        m.prismatic(rack, housing, middle, [0, 1, 0])
        row = m.between("rack", housing, middle)[0][1]
    check(kc(parts, axle), m, wheels, springs, axle, row)


def check(found, m, wheels, springs, axle, row=None, **more):
    expected = measures(m, wheels, springs, WHEELBASE, HEIGHT, axle == "front", 0.6, 0.7, rack=row, **more)
    compare(found, expected, 1e-6)
    for name, matrix in zip(("centre", "contact"), compliance(m, wheels, row), strict=True):
        difference = getattr(found.compliance, name) - matrix
        assert np.max(np.abs(difference)) < 1e-6 * np.max(np.abs(matrix)), name


def sides_of(points):
    return [{name: p * [1, sign, 1] for name, p in points.items()} for sign in (1, -1)]


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("rigid", [True, False], ids=["rigid", "bushing"])
@pytest.mark.parametrize("axle", ["front", "rear"])
def test_twist_beams(axle, rigid):
    rng = np.random.default_rng([axle == "front", rigid, 1])
    points, angles = drawn("twist_beam", "pivot_outer pivot_inner beam strut_seat strut_tower", rng)
    points["beam"][1] = 0
    m, k_b, spring, torsion = Linear(), rng.uniform(1e6, 5e6), rng.uniform(15e3, 40e3), rng.uniform(5e3, 15e3)
    at, mirrored = sides_of(points)
    arms = twist_beam(m, at, mirrored, rigid, k_b, spring, torsion)
    wheels = [wheel_of(*ends, each["wheel_centre"], **angles) for *ends, each in zip(SIGN, arms, (at, mirrored), strict=True)]  # fmt: skip
    given = {**{name: p.tolist() for name, p in points.items()}, **angles, "spring": spring, "strut_load": 0, "k_b": k_b, "torsion": torsion}  # fmt: skip
    part = {"use": "twist_beam", "parameters": given, "compliance": "rigid" if rigid else "bushing"}
    springs = [{"strut.strut": m.springs[k][0]} for k, each in enumerate(m.springs) if each[1] == spring]
    check(kc({axle: part}, axle), m, wheels, springs, axle)


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize("rigid", [True, False], ids=["rigid", "bushing"])
@pytest.mark.parametrize(("axle", "kingpins"), [("front", True), ("front", False), ("rear", False)])
def test_solid_axles(axle, kingpins, rigid):
    rng = np.random.default_rng([axle == "front", rigid, kingpins, 2])
    names = "front_eye clamp rear_eye shackle_top kingpin kingpin_axis track_arm drag_arm pitman_pivot pitman_ball"
    points, _ = drawn("rigid_axle", names, rng)
    given = {name: p.tolist() for name, p in points.items() if name != "wheel_centre"}
    points["wheel_left"] = points.pop("wheel_centre")
    k_b, spring, row = rng.uniform(2e6, 1e7), rng.uniform(15e3, 40e3), None
    m, both = Linear(), sides_of(points)
    solid = m.body("axle")
    carriers = [solid, solid]
    if kingpins:
        carriers = [m.body("left.upright"), m.body("right.upright")]
        for carrier, at in zip(carriers, both, strict=True):
            m.revolute(carrier, solid, at["kingpin"], at["kingpin_axis"])
        m.rod(carriers[0], both[0]["track_arm"], carriers[1], both[1]["track_arm"])
        pitman = m.body("pitman")
        m.revolute(pitman, None, points["pitman_pivot"], [0, -1, 0])
        m.rod(pitman, points["pitman_ball"], carriers[0], points["drag_arm"])
        row = -m.motion(pitman, points["pitman_pivot"])[1][1]
    for side, at in zip(SIGN, both, strict=True):
        leaf(m, side, solid, at, rigid, k_b, spring)
    wheels = [wheel_of(side, carrier, at["wheel_left"]) for side, carrier, at in zip(SIGN, carriers, both, strict=True)]
    parameters = {**given, "wheel_left": points["wheel_left"].tolist(), "spring": spring, "spring_load": 0, "k_b": k_b}
    words = {"compliance": "rigid" if rigid else "bushing", "steering": "kingpins" if kingpins else "none"}
    found = kc({axle: {"use": "rigid_axle", "parameters": parameters, **words}}, axle)
    if row is not None:
        row = np.pad(row, (0, 6 * len(m.bodies) - len(row)))
    check(found, m, wheels, [{}, {}], axle, row, solid=not kingpins, angular=True)


@pytest.mark.long
@pytest.mark.parametrize("rigid", [True, False], ids=["rigid", "bushing"])
def test_an_anti_roll_bar(rigid):
    """It adds to the roll rate, and to the compliance under one load, what its torsion, links and bushings do."""
    rng = np.random.default_rng([rigid, 3])
    (points, _), (bar, _) = (drawn(part, names, rng) for part, names in (("double_wishbone", CORNERS["double_wishbone"]), ("anti_roll_bar", "pivot end link")))  # fmt: skip
    m, k_b, k, torsion = Linear(), 8e6, rng.uniform(2e4, 5e4), rng.uniform(300, 1500)
    wheels, springs, lower = [], [], {}
    for side, at in zip(SIGN, sides_of(points), strict=True):
        upright = corner(m, "double_wishbone", side, at, None, rigid, k_b, k)
        springs.append({"strut.strut": m.springs[-1][0]})
        wheels.append(wheel_of(side, upright, at["wheel_centre"]))
        lower[side] = f"{side}.lower"
    halves = [m.body("left_half"), m.body("right_half")]
    for half, side, at in zip(halves, SIGN, sides_of(bar), strict=True):
        if rigid:
            m.revolute(half, None, at["pivot"], [0, 1, 0])
            m.rod(half, at["end"], lower[side], at["link"])
        else:
            m.bushing(half, None, at["pivot"], turned_to([0, 1, 0]), [5e6, 5e6, 1e6, 500, 500, 0])
            m.spring(half, at["end"], lower[side], at["link"], 1e6)
    if not rigid:
        m.revolute(*halves, bar["pivot"] * [1, 0, 1], [0, 1, 0])
    m.torsion(*halves, [0, 1, 0], torsion)
    word = {"compliance": "rigid" if rigid else "bushing"}
    given = {**{name: p.tolist() for name, p in points.items()}, "spring": k, "strut_load": 0, "k_b": k_b}
    parts = {f"front.{side}": {"use": "double_wishbone", "parameters": given, **word} for side in SIGN}
    parts["front.right"]["mirror"] = "y"
    of_bar = {**{name: bar[name].tolist() for name in ("pivot", "end", "link")}, "stiffness": torsion}
    mounts = {"left": "front.left.lower.arm", "right": "front.right.lower.arm"}
    check(kc({**parts, "bar": {"use": "anti_roll_bar", "mounts": mounts, "parameters": of_bar, **word}}, "front"), m, wheels, springs, "front")  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("axle", ["front", "rear"])
def test_ackermann_of_front_and_rear_steering(axle):
    """Rear wheels that steer to the left turn the car to the right, about a point on the line of the front wheels."""
    parts = {"steering": {"use": "steering_rack", "compliance": "rigid"}}
    for side in SIGN:
        points = {"tie_outer": [0.12, 0.66, 0.28]}  # nearer to the car than the ball joints
        parts[f"{axle}.{side}"] = {"use": "double_wishbone", "mounts": {"rack": "steering.rack"}, "compliance": "rigid", "parameters": points}  # fmt: skip
    parts[f"{axle}.right"]["mirror"] = "y"
    channels = kc(parts, axle, steer=20).sweeps["steer"].channels
    left, right = np.radians(-channels["left.toe"]), np.radians(channels["right.toe"])
    half, reached = channels["axle.track"] / 2000, []
    for a, b, width, given in zip(left, right, half, channels["axle.ackermann"], strict=True):
        if abs(a) < 1e-9:
            assert np.isnan(given)
            continue
        turn = np.sign(a) * (1 if axle == "front" else -1)  # 1 to the left
        outer, inner = (b, a) if turn > 0 else (a, b)
        ideal = np.arctan(WHEELBASE / (WHEELBASE / np.tan(abs(outer)) - 2 * width))
        reached.append(given)
        assert given == pytest.approx(100 * (abs(inner) - abs(outer)) / (ideal - abs(outer)), rel=2e-3)
    assert len(reached) == 4
