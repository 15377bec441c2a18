"""Beams in scenes, parts and Python models, and messages for bad input."""

import math

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedTorque, BeamBody, Fixed, InputError, Model, read_scene, spatial
from stiffmbs.model.beams.stiffness import node_weights

SECTION = "section: {type: circle, diameter: 20 mm}"
MATERIAL = "material: {E: 5 MPa, density: 1100}"
GOOD = f"{{type: beam, start: [0, 0], end: [1, 0], elements: 4, {SECTION}, {MATERIAL}}}"


def message(text):
    with pytest.raises(InputError) as found:
        read_scene(text)
    return str(found.value)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (("end: [1, 0]", "end: [0, 0]"), "bodies.s.end: found the points 1 and 2 at the same place"),
        (("E: 5 MPa", "E: -5 MPa"), "bodies.s.material.E: found -5 MPa, expected a pressure greater than 0"),
        ((SECTION + ", ", ""), "bodies.s.section: found nothing, expected a value"),
        ((", " + MATERIAL, ""), "bodies.s.material: found nothing, expected a value"),
        (("circle", "circel"), "did you mean 'circle'?"),
        (("type: beam", "type: baem"), "bodies.s.type: found 'baem' (did you mean 'beam'?)"),
        (("elements", "element"), "did you mean 'elements'?"),
        (("elements: 4", "elements: 4.5"), "bodies.s.elements: found 4.5, expected a whole number"),
        (("elements: 4", "elements: 0"), "bodies.s.elements: found 0, expected a number of 1 or more"),
        (("elements: 4", "elements: 4, stations: {m: 2 m}"), "bodies.s.stations.m: found 2 m, expected less than the length"),
        (("elements: 4", "elements: 4, stations: {end: 0.2}"), "bodies.s.stations: found the name 'end'"),
        (("elements: 4", "elements: 4, stiffness: [1, 1, 1]"), "bodies.s: found both 'section' and numbers"),
        (("end: [1, 0]", "end: [1, 0], through: [2, 0]"), "bodies.s.through: found a beam that reverses its direction"),
        (("start: [0, 0], end: [1, 0]", "points: [[0, 0], [1, 0], [0.5, 0]]"), "reverses its direction at point 2"),
        (("end: [1, 0], elements: 4", "end: [1e-3, 0], through: [0.5, 1], elements: 1"), "expected more elements"),
        (("diameter: 20 mm", "diameter: 20 N"), "bodies.s.section.diameter: found '20 N'"),
        (("type: circle, diameter: 20 mm", "type: tube, diameter: 20 mm, thickness: 10 mm"), "a solid bar is"),
        (("end: [1, 0]", "end: [1, 0, 0]"), "bodies.s.end: found 3 values, expected 2"),
        (("[0, 0], end: [1, 0]", "[0, 0, 0], end: [1, 0, 0]"), "dimensions: found none, expected 3 for beams in space"),
    ],
)  # fmt: skip
def test_bad_beams_are_reported_in_one_sentence(change, expected):
    text = f"bodies: {{s: {GOOD.replace(*change)}}}"
    assert text != f"bodies: {{s: {GOOD}}}"
    assert expected in message(text)


def test_bad_references_are_reported():
    beam = f"bodies: {{s: {GOOD}}}\n"
    assert "expected s.start, s.node1" in message(beam + "joints: {c: {type: fixed, i: s, j: ground}}")
    assert "found the unknown body 's.node99'" in message(beam + "joints: {c: {type: fixed, i: s.node99, j: ground}}")
    load = "forces: {c: {type: distributed_load, beam: t, force: [0, 1]}}"
    assert "forces.c.beam: found the unknown beam 't', expected s" in message(beam + load)
    assert "expected one of type beam" in message("bodies: {s: {mass: 1, inertia: 1}}\n" + load)
    assert "found the name of a node of the beam 's'" in message(
        f"bodies: {{s: {GOOD}, s.end: {{mass: 1, inertia: 1}}}}"
    )
    assert "bodies.t: found the name 't', which is reserved" in message(f"bodies: {{t: {GOOD}}}")
    across = "dimensions: 3\nbodies: {s: {type: beam, start: [0, 0, 0], end: [1, 0, 0], up: [1, 0, 0], elements: 1, "
    assert "bodies.s.up: found no direction across the beam" in message(f"{across}{SECTION}, {MATERIAL}}}}}")


def test_a_straight_beam_has_the_mass_the_centre_and_the_inertia_of_the_rod():
    for n in (2, 3, 4, 5, 6, 7, 20):
        weights, places = node_weights(n), np.arange(n + 1) - n / 2
        assert np.all(weights > 0) and weights.sum() == pytest.approx(n)
        assert weights @ places == pytest.approx(0, abs=1e-12) and weights @ places**2 == pytest.approx(n**3 / 12)


def test_an_arc_has_its_length_and_its_curvature():
    scene = read_scene(
        f"bodies: {{s: {GOOD.replace('end: [1, 0]', 'end: [2, 0], through: [1, 1]')}}}"
    )  # half a circle of radius 1, turning clockwise
    element = scene.forces["s.element1"]
    assert element.unloaded == pytest.approx((1, 0, -1)) and element.length == pytest.approx(math.pi / 4)
    assert sum(body.mass for body in scene.bodies.values()) == pytest.approx(math.pi * 1100 * math.pi * 0.01**2)
    assert [scene.bodies[f"s.{node}"].angle for node in ("start", "end")] == pytest.approx([math.pi / 2, -math.pi / 2])


@pytest.mark.long
def test_a_beam_without_loads_is_at_rest_in_any_form():
    found = stiffmbs.run(
        read_scene(f"""
dimensions: 3
bodies:
  s:
    {{type: beam, points: [[0, 0, 0], [1, 0, 0], [1, 2, 0], [1, 2, 3]], elements: 9, stations: {{a: 0.7 m, b: 4 m}}, {SECTION}, {MATERIAL}}}
  u:
    {{type: beam, start: [0, 1, 0], through: [1, 2, 1], end: [0, 3, 3], up: [1, 0, 0.3], elements: 7, {SECTION}, {MATERIAL}}}
run: {{duration: 1 s, points: 2}}
""")
    )
    moved = [abs(np.ptp(values)) for name, values in found.channels.items() if name.rpartition(".")[2] in "xyz"]
    assert max(moved) < 1e-9


def test_stations_are_nodes_at_their_places():
    scene = read_scene(f"bodies: {{s: {GOOD.replace('elements: 4', 'elements: 4, stations: {middle: 0.3 m}')}}}")
    assert scene.bodies["s.middle"].position == pytest.approx((0.3, 0)) and len(scene.bodies) == 5


def test_a_beam_in_a_part_and_its_mirror_image_move_alike():
    found = stiffmbs.run(
        read_scene("""
dimensions: 3
gravity: [0, 0, -9.81]
parts:
  rod:
    parameters: {L: 1 m}
    bodies:
      arm: {type: beam, points: [[0, 0, 0], [L, 0, 0], [L, L/2, 0.1]], elements: 5, section: {type: rectangle, width: 10 mm, height: 20 mm},
            material: {E: 50 MPa, density: 1100}, up: [0, 0.2, 1]}
    joints: {clamp: {type: fixed, i: arm.start, j: {body: mount, orientation: {x: [1, 0, 0], z: [0, 0.2, 1]}}}}
use:
  a: {part: rod}
  b: {part: rod, mirror: y}
run: {duration: 0.2 s, points: 3, rtol: 1e-7}
""")
    )
    for axis, sign in (("x", 1), ("y", -1), ("z", 1)):
        one, other = (found[f"{part}.arm.end.{axis}"] for part in "ab")
        assert one == pytest.approx(sign * other, abs=1e-6)
    assert np.ptp(found["a.arm.end.z"]) > 0.01


def test_a_beam_in_a_python_model():
    model = Model("roll-up")
    strip = model.add(
        "strip",
        BeamBody(
            start=(0, 0),
            end=("1 m", 0),
            elements=8,
            stiffness=(1e4, 1e4, 1),
            mass_per_length=1,
            inertia_per_length=0.01,
        ),
    )
    model.add("clamp", Fixed(i=strip.start, j="ground"))
    model.add("M", AppliedTorque(i=strip.end, torque=math.tau))
    assert list(strip) == ["start", *(f"node{k}" for k in range(1, 8)), "end"]
    assert stiffmbs.equilibrium(model).channels["strip.end.x"] == pytest.approx(0, abs=1e-9)
    with pytest.raises(AttributeError, match="did you mean 'end'"):
        strip.ende  # noqa: B018 it is to fail
    with pytest.raises(InputError, match="expected more elements"):
        model.add("b", BeamBody(start=(0, 0), end=(1e-3, 0), through=(0.5, 1), elements=1, stiffness=(1, 1, 1), mass_per_length=1, inertia_per_length=1))  # fmt: skip
    in_space = spatial.Model("bar")
    bar = in_space.add(
        "bar",
        spatial.BeamBody(
            start=(0, 0, 0), end=(0, 0, 1), elements=2,
            section={"type": "tube", "diameter": "20 mm", "thickness": "2 mm"}, material={"E": "1 GPa", "density": 2000},
        ),
    )  # fmt: skip
    assert bar.end.position == pytest.approx((0, 0, 1))


def test_values_of_a_beam_can_be_set_from_outside():
    text = f"parameters: {{n: 4}}\nbodies: {{s: {GOOD.replace('elements: 4', 'elements: n')}}}"
    assert len(read_scene(text, [("n", "6")]).bodies) == 7
    assert len(read_scene(text, [("bodies.s.elements", "3")]).bodies) == 4
    stiffer = read_scene(text, [("bodies.s.material.E", "10 MPa")])
    assert stiffer.forces["s.element1"].stiffness[0][0] == pytest.approx(
        2 * read_scene(text).forces["s.element1"].stiffness[0][0]
    )


def test_the_schema_describes_beams():
    import jsonschema
    import yaml

    schema = jsonschema.Draft202012Validator(stiffmbs.scene_schema())
    load = "forces: {c: {type: distributed_load, beam: s, force: [0, 1 N/m]}}"
    assert not list(schema.iter_errors(yaml.safe_load(f"bodies: {{s: {GOOD}}}\n{load}")))
    assert list(schema.iter_errors(yaml.safe_load(f"bodies: {{s: {GOOD.replace('diameter', 'radius')}}}")))
