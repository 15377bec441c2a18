"""Beams on planes: impact, elastic foundation, friction."""

import math

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, read_scene

from .scenes import RUBBER, at_rest

WEIGHT = math.pi * 0.01**2 * 1100 * 9.81
"""Per length of the rubber rod, N/m."""


def rod(dimensions, height, more="", contact="", n=8, run="duration: 0.6"):
    """A horizontal rubber rod above the ground of stiffness 1e4 N/m^2."""
    y = f"0, {height}" if dimensions == 3 else f"{height}"
    return f"""
dimensions: {dimensions}
gravity: [0, {"0, " if dimensions == 3 else ""}-9.81]
bodies: {{rod: {{type: beam, start: [0, {y}], end: [1, {y}], elements: {n}, {RUBBER}}}}}
forces:
  floor: {{type: beam_contact, beam: rod, j: ground, stiffness: 1e4 N/m^2 {contact}}}
{more}
run: {{{run}, points: 301, rtol: 1e-8, solver: radau}}
"""


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_beam_that_falls_flat_rebounds_as_one_mass_and_keeps_its_energy(dimensions):
    up = "y" if dimensions == 2 else "z"
    found = stiffmbs.run(read_scene(rod(dimensions, 0.11)))
    assert np.ptp(found["energy.total"]) < 1e-7 * found["energy.kinetic"].max()
    depth = (WEIGHT + math.sqrt(WEIGHT**2 + 2 * 1e4 * WEIGHT * 0.1)) / 1e4
    assert found[f"rod.node4.{up}"].min() == pytest.approx(0.01 - depth, abs=5e-5)
    assert np.ptp([found[f"rod.{node}.{up}"] for node in ("start", "node3", "end")], axis=0).max() < 1e-6


@pytest.mark.long
def test_a_point_load_on_an_elastic_foundation():
    """A long beam with shear that its weight keeps on the ground: the integral of P/pi (1 + EI/GA s^2)/(EI s^4 + k EI/GA s^2 + k)."""
    load = "  P: {type: force, i: rod.node20, force: [0, -0.3]}"
    found = at_rest(rod(2, 0.01, load, n=40))
    EI, GA = 5e6 * math.pi * 0.02**4 / 64, 0.886364 * 5e6 / 2.6 * math.pi * 0.01**2
    a = math.sqrt(1e4 / EI)
    deflection = 0.3 * (1 + a * EI / GA) / (2 * EI * a * math.sqrt(2 * a + 1e4 / GA))
    assert 0.01 - found["rod.node20.y"] == pytest.approx(WEIGHT / 1e4 + deflection, rel=2e-3)
    carried = sum(value for name, value in found.items() if name.startswith("floor.") and name.endswith(".fy"))
    assert carried == pytest.approx(WEIGHT + 0.3, rel=1e-9)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_beam_slides_with_the_friction_of_its_weight(dimensions):
    text = rod(dimensions, 0.01 - WEIGHT / 1e4, contact=", friction: 0.3", run="duration: 0.2")
    pull = "  pull: {type: force, i: rod.end, force: [5" + (", 0" * (dimensions - 1)) + "]}\nrun:"
    scene = read_scene(text.replace("run:", pull))
    found = stiffmbs.run(scene)
    momentum = sum(body.mass * found[f"{name}.vx"][-1] for name, body in scene.bodies.items())
    assert momentum == pytest.approx(0.2 * (5 - 0.3 * WEIGHT), rel=1e-2)


def test_a_contact_of_a_beam_may_be_with_a_circle_and_has_messages():
    text = rod(2, 0.51, n=8).replace("j: ground,", "j: ground, surface: circle, surface_radius: 0.3,")
    scene = read_scene(text)
    assert scene.forces["floor.node3"].surface_radius == 0.3 and scene.forces["floor.start"].radius == 0.01
    assert sum(scene.forces[name].stiffness for name in scene.forces if name.startswith("floor")) == pytest.approx(1e4)
    for change, expected in (
        (
            ("beam: rod", "beam: rad"),
            "forces.floor.beam: found the unknown beam 'rad' (did you mean 'rod'?), expected rod",
        ),
        (("stiffness: 1e4 N/m^2", ""), "forces.floor.stiffness: found nothing"),
        (("stiffness: 1e4 N/m^2", "stiffness: -3"), "expected a value greater than 0"),
        (("j: ground,", "i: rod.end,"), "forces.floor.i: found a marker of a beam contact"),
        (("j: ground,", ""), "floor.start.j: found nothing"),
        (("stiffness: 1e4", "frction: 0.3, stiffness: 1e4"), "did you mean 'friction'?"),
    ):
        with pytest.raises(InputError) as error:
            read_scene(text.replace(*change))
        assert expected in str(error.value)


def test_the_schema_describes_contacts_of_beams():
    import jsonschema
    import yaml

    schema = jsonschema.Draft202012Validator(stiffmbs.scene_schema())
    assert not list(schema.iter_errors(yaml.safe_load(rod(2, 0.1))))
    assert list(schema.iter_errors(yaml.safe_load(rod(2, 0.1).replace("stiffness: 1e4", "stifness: 1e4"))))


@pytest.mark.long
def test_a_cable_is_lifted_from_the_ground_as_a_catenary():
    """With the forces H and V at its end, V/w of its length is in the air."""
    found = at_rest("""
gravity: [0, -10]
bodies:
  cable: {type: beam, start: [0, 0], end: [4, 0], elements: 80, stiffness: [1e6, 1e6, 1e-3], mass_per_length: 1, inertia_per_length: 1e-5}
joints: {anchor: {type: revolute, i: cable.start, j: ground}}
forces:
  floor: {type: beam_contact, beam: cable, j: ground, stiffness: 1e5}
  pull: {type: force, i: cable.end, force: [10, 10]}
""")
    assert found["cable.end.y"] == pytest.approx(math.sqrt(2) - 1, abs=1e-3)
    assert found["cable.end.x"] == pytest.approx(3 + math.asinh(1), abs=1e-3)
    carried = sum(value for name, value in found.items() if name.startswith("floor.") and name.endswith(".fy"))
    assert carried + found["anchor.fy"] == pytest.approx(30, rel=1e-9) and found["anchor.fx"] == pytest.approx(
        -10, rel=1e-9
    )
