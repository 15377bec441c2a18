"""Parts: names, parameters, places, changes from outside, and what is refused."""

import json
import math
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from ruamel.yaml import YAML

import stiffmbs
from stiffmbs.errors import InputError

ARM = {
    "parameters": {"M": "1 kg", "l": "L/2"},
    "markers": {"stop": {"point": [0.1, -0.2]}},
    "bodies": {"bar": {"mass": "M", "inertia": 1, "position": ["l", 0], "markers": {"end": {"point": ["l", 0]}}}},
    "joints": {"pin": {"type": "revolute", "i": {"body": "bar", "point": ["-l", 0]}, "j": "mount"}},
    "forces": {"spring": {"type": "spring_damper", "i": "bar.end", "j": "mount.stop", "stiffness": 10}},
    "requests": {"height": "dy(bar.end, mount) + 2*bar.y + M*t*1 m/(1 kg s)"},
}


def scene(use, changes=(), **sections):
    found = {"gravity": [0, -9.81], "parameters": {"L": "1 m"}, "parts": {"arm": ARM}, "use": use, **sections}
    return stiffmbs.read_scene(json.dumps(found), changes)


def test_names_are_those_of_the_part_behind_those_of_its_use():
    found = scene(
        {"front.left": {"part": "arm"}, "right": {"part": "arm", "position": [0, 3]}},
        forces={"tie": {"type": "spring_damper", "i": "front.left.bar.end", "j": "right.bar", "stiffness": 1}},
        requests={"gap": "dm(front.left.bar.end, right.bar) + right.bar.x + vx(ground.right.stop, ground.right)"},
    )
    assert list(found.bodies) == ["front.left.bar", "right.bar"]
    assert list(found.joints) == ["front.left.pin", "right.pin"]
    assert (found.forces["tie"].i.body, found.forces["tie"].i.marker) == ("front.left.bar", "end")
    assert found.point(found.forces["right.spring"].j) == pytest.approx((0.1, 2.8))
    solution = stiffmbs.run(found, duration=0.1, points=3)
    for channel in ("front.left.bar.x", "right.pin.fx", "right.spring.fy", "front.left.height", "gap"):
        assert len(solution[channel]) == 3
    bar = {name: solution[f"front.left.bar.{name}"] for name in ("y", "angle")}
    expected = bar["y"] + 0.5 * np.sin(bar["angle"]) + 2 * bar["y"] + solution.time
    assert solution["front.left.height"] == pytest.approx(expected)
    with pytest.raises(InputError, match=r"expected one such as front.left.bar.x"):
        solution["front.left.bar.z"]


def test_a_part_in_its_place_is_as_if_it_were_written_there():
    """Turned by 30 degrees on a body that is itself turned; both solutions are the same numbers."""
    car = {"mass": 5, "inertia": 2, "position": [1, 2], "angle": "20 deg", "markers": {"at": {"point": [0.3, 0.1]}}}
    placed = scene({"a": {"part": "arm", "on": "car", "position": [0.3, 0.1], "angle": "30 deg"}}, bodies={"car": car})
    turned = math.radians(50)
    at = (
        1 + 0.3 * math.cos(math.radians(20)) - 0.1 * math.sin(math.radians(20)),
        2 + 0.3 * math.sin(math.radians(20)) + 0.1 * math.cos(math.radians(20)),
    )
    position = [at[0] + 0.5 * math.cos(turned), at[1] + 0.5 * math.sin(turned)]
    stop = [
        0.3 + 0.1 * math.cos(math.radians(30)) + 0.2 * math.sin(math.radians(30)),
        0.1 + 0.1 * math.sin(math.radians(30)) - 0.2 * math.cos(math.radians(30)),
    ]
    bar = {"mass": 1, "inertia": 1, "position": position, "angle": turned, "markers": {"end": {"point": [0.5, 0]}}}
    flat = stiffmbs.read_scene(json.dumps({
        "gravity": [0, -9.81],
        "bodies": {"car": car, "bar": bar},
        "joints": {"pin": {"type": "revolute", "i": {"body": "bar", "point": [-0.5, 0]}, "j": "car.at"}},
        "forces": {"spring": {"type": "spring_damper", "i": "bar.end", "j": {"body": "car", "point": stop}, "stiffness": 10}},
    }))  # fmt: skip
    first, second = (stiffmbs.run(one, duration=1, points=5, rtol=1e-9) for one in (placed, flat))
    for channel in ("x", "y", "angle", "vx", "omega"):
        assert first[f"a.bar.{channel}"] == pytest.approx(second[f"bar.{channel}"], abs=1e-7)


def test_parameters_are_formulas_of_those_outside():
    found = scene({"a{k}": {"for": "k in 1..3", "part": "arm", "parameters": {"M": "k*L*2 kg/m", "l": "L"}}})
    assert [body.mass for body in found.bodies.values()] == [2, 4, 6]
    assert found.bodies["a2.bar"].position == (1, 0)


def test_changes_reach_parts_uses_and_instances():
    use = {"front.left": {"part": "arm"}, "right": {"part": "arm"}}
    changes = [
        ("bodies.front.left.bar.mass", "7"),
        ("use.right.parameters.M", "8"),
        ("parts.arm.bodies.bar.inertia", "9"),
    ]
    found = scene(use, changes)
    assert (found.bodies["front.left.bar"].mass, found.bodies["right.bar"].mass) == (7, 8)
    assert found.bodies["right.bar"].inertia == 9
    with pytest.raises(InputError, match=r"--set bodies.front.left.ba.mass: found no such place"):
        scene(use, [("bodies.front.left.ba.mass", "7")])


def test_parts_within_parts():
    pair = {"use": {"upper": {"part": "arm", "position": [0, 1]}, "lower": {"part": "arm", "on": "upper.bar", "position": ["L/2", 0]}},
            "forces": {"tie": {"type": "spring_damper", "i": "upper.bar", "j": "lower.bar.end", "stiffness": 1}}}  # fmt: skip
    use = {"left": {"part": "pair", "position": [1, 0]}, "right": {"part": "pair", "position": [-1, 0], "mirror": "x"}}
    found = scene(use, parts={"arm": ARM, "pair": pair})
    assert found.bodies["left.lower.bar"].position == pytest.approx((2.5, 1))
    assert found.bodies["right.lower.bar"].position == pytest.approx((-2.5, 1))
    solution = stiffmbs.run(found, duration=0.5, points=4, rtol=1e-9)
    assert solution["right.lower.bar.x"] == pytest.approx(-solution["left.lower.bar.x"], abs=1e-9)
    assert solution["right.lower.bar.angle"] == pytest.approx(-solution["left.lower.bar.angle"], abs=1e-9)


def _with(**changes):
    return {"arm": {**ARM, **changes}}


CURVE = {"c": {"type": "point_on_curve", "i": "bar", "j": "mount", "y": "0*x"}}
MIRRORED = {"a": {"part": "arm", "mirror": "x"}}


def _force(*components):
    return {"f": {"type": "force", "i": "bar", "force": list(components)}}


@pytest.mark.parametrize(
    ("found", "reason"),
    [
        ({"use": {"a": {"part": "leg"}}}, r"use.a.part: found 'leg', expected one of parts \(arm\)"),
        ({"use": {"a": {}}}, "use.a.part: found nothing"),
        ({"use": {"a": 3}}, "use.a: found 3, expected a mapping with 'part'"),
        ({"use": [1]}, r"use: found \[1\], expected a mapping of names to parts"),
        ({"use": {"a..b": {"part": "arm"}}}, r"use: found a part with the name 'a..b'"),
        ({"use": {"mount": {"part": "arm"}}}, "use.mount: found the name of what a part is placed on"),
        ({"use": {"a": {"part": "arm", "on": "car"}}}, "use.a.on: found 'car', expected ground, a body"),
        ({"use": {"a": {"part": "arm", "mirror": "z"}}}, "use.a.mirror: found 'z', expected 'x' or 'y'"),
        ({"use": {"a": {"part": "arm", "orientation": 3}}}, "use.a: found the unknown key 'orientation'"),
        ({"use": {"a": {"part": "arm", "parameters": {"n": 3}}}}, "use.a.parameters.n: found no such parameter of 'arm', expected one of M, l"),
        ({"use": {"a": {"part": "arm", "parameters": {"M": "1 +"}}}}, r"use.a.parameters.M: found '1 \+'"),
        ({"parts": _with(parameters={"sin": 1})}, "parts.arm.parameters.sin: found the name of a constant or function"),
        ({"parts": _with(body=3)}, "parts.arm: found the unknown key 'body'"),
        ({"parts": _with(bodies=3)}, "parts.arm.bodies: found 3, expected a mapping"),
        ({"parts": {"arm": 3}}, "parts.arm: found 3, expected a mapping"),
        ({"parts": _with(forces={"bar": {}})}, "parts.arm.forces.bar: found a name that bodies.bar has too"),
        ({"parts": _with(joints={"pin": {"type": "revolute", "i": "bar.en", "j": "mount"}})}, "joints.a.pin.i: found 'a.bar.en'"),
        ({"parts": _with(joints={"pin": {"type": "revolute", "i": "bar", "j": "mount.en"}})}, "joints.a.pin.j: found 'ground.a.en'"),
        ({"parts": _with(joints={"pin": {"type": "revolve"}})}, r"parts.arm.joints.pin: found the type 'revolve'.*\(in a\)"),
        ({"parts": _with(use={"b": {"part": "arm"}})}, "parts.arm.use.b: found 'arm', which it stands in"),
        ({"bodies": {"a": {"mass": 1, "inertia": 1}}}, "found 'a' before a dot in 'a.bar'"),
        ({"bodies": {"a.bar": {"mass": 1, "inertia": 1}}}, "bodies.a.bar: found a name that a part makes too"),
        ({"use": MIRRORED, "parts": _with(joints=CURVE)}, "joints.c: found the type point_on_curve in a mirrored part"),
        ({"use": MIRRORED, "parts": _with(forces=_force("bar.x", 0))}, r"forces.f.force: found 'a.bar.x' in a mirrored part.*\(in a\)"),
        ({"use": MIRRORED, "parts": _with(forces=_force("dx(bar, ground)", 0))}, "found 'ground' in 'dx.*outside of a mirrored part"),
        ({"use": {"a": {**MIRRORED["a"], "angle": 1}}, "parts": _with(forces=_force(1, 0))}, "found axes: ground, to which the part's mirror is oblique"),
        ({"use": {f"a{k}": {"part": f"p{k}"} for k in range(1)}, "parts": {f"p{k}": {"use": {x: {"part": f"p{k + 1}"} for x in "abcdefgh"}} for k in range(20)}}, "nested deeper than 10"),
        ({"use": {"a": {"part": "p0"}}, "parts": {**{f"p{k}": {"use": {x: {"part": f"p{k + 1}"} for x in "abcdefgh"}} for k in range(8)}, "p8": {}}}, "found more than 10000 parts in their places"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_in_one_sentence_with_its_place(found, reason):
    with pytest.raises(InputError, match=reason) as told:
        scene(**{"use": {"a": {"part": "arm"}}, **found})
    assert "\n" not in str(told.value)


@pytest.mark.long
def test_values_of_all_parts_are_bounded(monkeypatch):
    monkeypatch.setattr("stiffmbs.model.parts.instances.MOST_VALUES", 1000)
    with pytest.raises(InputError, match="found parts of more than 1000 values"):
        scene({"a{k}": {"for": "k in 1..100000", "part": "arm"}})


def test_a_mirrored_height_is_that_height():
    found = scene(MIRRORED, parts=_with(forces=_force(0, "-bar.y - dy(bar, ground)")))
    assert found.forces["a.f"].force[1].text == "-a.bar.y - dy(a.bar, ground)"


def test_the_schema_knows_parts():
    schema = jsonschema.Draft202012Validator(stiffmbs.scene_schema())
    example = YAML(typ="safe").load(Path("examples/vehicles/front_axle.yaml"))
    schema.validate(example)
    for wrong in (
        {"use": {"a": {"on": "car"}}},
        {"parts": {"a": {"body": {}}}},
        {"include": 3},
        {"bodies": None, "name": 3},
    ):
        assert not schema.is_valid({**example, **wrong})


def test_a_name_with_dots_may_stand_anywhere():
    """Written by hand, as in a scene that was made flat: body, marker, joint and coordinate are told apart."""
    bar = {"mass": 1, "inertia": 1, "markers": {"c.d": {}}}
    found = {
        "bodies": {"a.b": bar},
        "joints": {
            "p.q": {"type": "revolute", "i": "a.b.c.d", "j": "ground"},
            "d.r": {"type": "drive", "joint": "p.q.angle", "position": "t"},
        },
        "requests": {"x.y": "az(a.b.c.d, ground) + a.b.angle"},
    }
    solution = stiffmbs.run(stiffmbs.read_scene(json.dumps(found)), duration=1, points=3)
    assert solution["x.y"] == pytest.approx(2 * solution.time)
    for wrong in ("a.b.c", "a.b"):
        with pytest.raises(InputError, match=r"found 'a.b' before a dot|found a name that bodies.a.b has too"):
            stiffmbs.read_scene(json.dumps({**found, "requests": {wrong: "t"}}))
    with pytest.raises(InputError, match=r"found 'energy' before a dot in 'energy.b'"):
        stiffmbs.read_scene(json.dumps({"bodies": {"energy.b": bar}}))


def test_angles_and_reactions_of_parts_are_requested_in_space():
    bar = {
        "mass": 1,
        "inertia": [1, 2, 2.5],
        "omega": [0, 0, 3],
        "velocity": [0, -3, 0],
        "markers": {"end": {"point": [1, 0, 0]}},
    }
    part = {
        "bodies": {"bar": bar},
        "joints": {"pin": {"type": "revolute", "i": "bar.end", "j": {"body": "mount", "point": [1, 0, 0]}}},
        "requests": {"turns": {"z": "az(bar.end, mount)", "f": "fx(pin.j) + fx(pin, bar.end) + bar.x"}},
    }
    found = {
        "dimensions": 3,
        "parts": {"arm": part},
        "use": {"a.b": {"part": "arm"}},
        "requests": {"out": "az(a.b.bar.end, ground.a.b) + fx(a.b.pin.i)"},
    }
    solution = stiffmbs.run(stiffmbs.read_scene(json.dumps(found)), duration=4, points=9)
    assert solution["a.b.turns.z"] == pytest.approx(3 * solution.time, rel=1e-5)
    assert solution["out"] == pytest.approx(solution["a.b.turns.z"] + solution["a.b.pin.fx"], abs=1e-9)
    along = np.cos(3 * solution.time) * solution["a.b.pin.fx"] + np.sin(3 * solution.time) * solution["a.b.pin.fy"]
    assert solution["a.b.turns.f"] == pytest.approx(
        along - solution["a.b.pin.fx"] + solution["a.b.bar.x"], abs=1e-3
    )  # along the bar's own axes, and on the other body


def test_parts_use_variables_of_the_scene():
    variables = {"gap": "dm(a.bar, ground) + 0.5*b.bar.x", "pull": "2*gap*1 N/m", "weight": "L*1 N/m"}
    forces = {"f": {"type": "force", "i": "bar", "force": ["pull", "weight"]}}
    found = scene({"a": {"part": "arm"}, "b": {"part": "arm"}}, parts=_with(forces=forces), variables=variables)
    body_values = stiffmbs.run(found, duration=0.1, points=2)
    written = {"gap": "dm(a.bar, ground) + 0.5*b.bar.x"}
    force = {"type": "force", "i": "a.bar", "force": [f"2*({written['gap']})*1 N/m", "1 N"]}
    both = {"f": force, "g": {**force, "i": "b.bar"}}
    flat = scene({"a": {"part": "arm"}, "b": {"part": "arm"}}, parts=_with(forces={}), forces=both)
    expected = stiffmbs.run(flat, duration=0.1, points=2)
    assert body_values["b.bar.y"] == pytest.approx(expected["b.bar.y"], abs=1e-12)
    assert body_values["b.bar.y"][-1] != pytest.approx(0, abs=1e-3)


def test_a_parameter_of_a_part_hides_the_variables_that_use_an_outer_one_of_its_name():
    """They would be another formula there than in the scene."""
    forces = {"f": {"type": "force", "i": "bar", "force": ["weight", 0]}}
    part = _with(forces=forces, parameters={**ARM["parameters"], "L": "3 m"})
    with pytest.raises(InputError, match=r"parts.arm.forces.f.force.* 'weight'.*\(in a\)"):
        scene({"a": {"part": "arm"}}, parts=part, variables={"weight": "L*1 N/m"})


def test_what_parameters_of_parts_stand_for_is_written_with_a_model():
    """Two instances have other values; the text of the model has no parts."""
    forces = {"f": {"type": "force", "i": "bar", "force": ["M*2 m/s^2*t/(1 s)", 0]}}
    use = {"a": {"part": "arm"}, "b": {"part": "arm", "parameters": {"M": "0.5 kg", "l": 0.25}}}
    found = scene(use, parts=_with(forces=forces))
    model = stiffmbs.Model("arms", found.gravity)
    for section in ("markers", "bodies", "joints", "forces", "requests"):
        getattr(model, section).update(getattr(found, section))
    again = stiffmbs.read_scene(model.to_scene())
    first, second = (stiffmbs.run(one, duration=0.2, points=3) for one in (found, again))
    for channel in ("a.bar.x", "b.bar.x", "a.height", "b.height"):
        assert second[channel] == pytest.approx(first[channel], abs=1e-9)
