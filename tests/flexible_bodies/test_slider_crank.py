"""Flexible slider-crank (Simeon, 1996; problem 'crank' of the IVP test set) against equations in minimal coordinates."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from skfem import MeshHex, MeshHex2
from skfem.io.meshio import to_meshio

from stiffmbs import InputError, read_scene, run
from stiffmbs.analyses.job import prepare
from stiffmbs.flexible_bodies.reduced import reduced_body

from ..conftest import EXAMPLE_SCENES

HEIGHT, LENGTH, CRANK, RATE = 0.008, 0.3, 0.15, 150.0
TIMES = np.array([0.04, 0.08, 0.1])


@dataclass(frozen=True)
class Motion:
    """Deflection of the middle of the rod from its chord, m, and angle of the chord, rad, at `TIMES`."""

    deflection: np.ndarray
    angle: np.ndarray


UNDEFORMED = Motion(
    np.array([-1.100445e-3, -1.813306e-3, -1.38890e-4]), np.array([0.14016364, 0.27160368, -0.33117710])
)
"""From an undeformed rod, by integration of Simeon's equations with linear strains, relative tolerance 1e-11.

Two bending modes and five axial shapes. The angle with two axial shapes is -0.33119285 at 0.1 s: the rod vibrates along
its axis without damping, by 2e-5 m, and the phase after 270 periods depends on every part in 10^4 of the frequency."""
PHASE = 3.5e-5
"""Change of the angle, rad, by the phase of this vibration."""
PUBLISHED = Motion(np.array([-8.6139e-4, -1.46323e-3, 1.89308e-4]), np.array([0.14015874, 0.27160164, -0.33117343]))
"""From the published start, which has no such vibration; two bending modes and two axial shapes."""
SINES, RATES_OF_SINES = (0.0, 0.0), (0.444896105, 4.63434311e-3)
AXIAL, RATES_OF_AXIAL = (1.03339863e-5, 1.69327969e-5), (-1.78591076e-6, -2.68938672e-6)
"""Published start: coordinates of the bending modes, and axial displacements of the middle and of the end, m and m/s."""


def crank(folder: Path):
    """Return the scene with an undamped rod of linear strains.

    The equations are those of Euler and Bernoulli; a stiffer modulus compensates shear and rotary inertia of the solid.
    """
    width = 1e3 * np.linspace(-HEIGHT / 2, HEIGHT / 2, 2)
    cells = MeshHex.init_tensor(1e3 * np.linspace(0, LENGTH, 31), width, width)
    to_meshio(MeshHex2.from_mesh(cells)).write(folder / "flexible_rod.vtu")
    shear = 2 * 1.3 / 0.85  # E/(k G), Cowper's factor for a square
    stiffer = 1 + np.pi**2 * HEIGHT**2 / (12 * LENGTH**2) * (1 + shear)
    changes = {
        "E: 200 GPa": f"E: {200 * stiffer} GPa",
        "zeta: 0.02": "zeta: 0",
        "modes: 4": "modes: 4\n    stiffening: false",
        "      slider_end: {plane": "      middle: {plane: {point: [l2/2, 0, 0], normal: [1, 0, 0]}, type: average}\n      slider_end: {plane",
        "output: 20 us, rtol: 1e-6": "points: 6, rtol: 1e-7",
    }
    return read_scene(_changed(changes), file=folder / "crank.yaml")


def _changed(changes):
    text = EXAMPLE_SCENES["flexible_slider_crank"].read_text()
    for old, new in changes.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    return text


def motion(scene) -> Motion:
    """Return the motion of a scene."""
    found = run(scene)
    start, middle, end = (
        np.array([found[f"rod.{name}.{axis}"] for axis in "xy"]) for name in ("crank_end", "middle", "slider_end")
    )
    chord, arm = end - start, middle - start
    deflection = (chord[0] * arm[1] - chord[1] * arm[0]) / np.hypot(*chord)
    at = np.searchsorted(found.t, TIMES - 1e-9)
    return Motion(deflection[at], found["rod_angle"][at])


def _deformed(scene):
    """Return the scene with the published start."""
    frame = scene.bodies["rod.frame"]
    body, folder = frame.source
    reduced, model = reduced_body(body, folder), body.model(folder)
    at, y = model.nodes[:, 0] / LENGTH, model.nodes[:, 1]

    def coordinates(sines, axial):
        waves = np.pi * np.array([[1.0], [2.0]])
        field = np.zeros((len(at), 3))
        field[:, 0] = 4 * at * (1 - at) * axial[0] + at * (2 * at - 1) * axial[1]
        field[:, 0] -= y * (sines @ (waves / LENGTH * np.cos(waves * at)))
        field[:, 1] = sines @ np.sin(waves * at)
        return reduced.modes.T @ (model.mass @ field.ravel())

    q, v = coordinates(SINES, AXIAL), coordinates(RATES_OF_SINES, RATES_OF_AXIAL)
    first, last = (reduced.markers[list(body.interfaces).index(name)] for name in ("crank_end", "slider_end"))
    chord = LENGTH + (last[0] - first[0]) @ q
    spin = np.array([0, 0, -(CRANK * RATE + (last[1] - first[1]) @ v) / chord])
    places = reduced.points - reduced.centre + reduced.markers[:, :3] @ q
    by_shape = np.cross(spin, places) + reduced.markers[:, :3] @ v
    velocity = np.array([0, CRANK * RATE, 0]) - by_shape[list(body.interfaces).index("crank_end")]
    bodies = dict(scene.bodies)
    bodies["rod.frame"] = frame.model_copy(update={"velocity": tuple(velocity), "omega": tuple(spin)})
    for k, name in enumerate(body.interfaces):
        rates = {"velocity": tuple(velocity + by_shape[k]), "omega": tuple(spin + reduced.markers[k, 3:] @ v)}
        bodies[f"rod.{name}"] = bodies[f"rod.{name}"].model_copy(update=rates)
    names = [name for name in bodies if name.startswith("rod.modes")]
    places, rates = (np.resize([*each, *[0] * 3], (len(names), 3)) / np.sqrt(reduced.mass) for each in (q, v))
    for name, position, rate in zip(names, places, rates, strict=True):
        bodies[name] = bodies[name].model_copy(update={"position": tuple(position), "velocity": tuple(rate)})
    return scene.model_copy(update={"bodies": bodies})


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("start, expected, within", [("published", PUBLISHED, 1e-6), ("undeformed", UNDEFORMED, PHASE)])
def test_the_rod_of_a_slider_crank_bends_as_a_beam(tmp_path, start, expected, within):
    scene = crank(tmp_path)
    found = motion(scene if start == "undeformed" else _deformed(scene))
    assert found.deflection == pytest.approx(expected.deflection, abs=0.01 * np.abs(expected.deflection).max())
    assert found.angle == pytest.approx(expected.angle, abs=within)


def test_velocities_that_are_not_described_do_not_deform_a_body():
    """The rod was struck by a crank that turns from the start: 13.7 mm of deflection, with its velocities given 2.0 mm."""
    file = EXAMPLE_SCENES["flexible_slider_crank"]
    given = "    velocity: [0, rate*l1/2, 0]\n    omega: [0, 0, -rate*l1/l2]\n"
    expected, found = (prepare(read_scene(text, file=file)) for text in (file.read_text(), _changed({given: ""})))
    assert np.abs(expected.start.u).max() > RATE / 2
    np.testing.assert_allclose(found.start.u, expected.start.u, atol=1e-9 * RATE)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (("  motor:", "  rod.modes1_axes: {type: point_on_plane, i: slider, j: ground}\n  motor:"), "joints.rod.modes1_axes"),
        (("  slider:\n", "  rod.modes1: {mass: 1, inertia: [1, 1, 1]}\n  slider:\n"), "bodies.rod.modes1"),
    ],
)  # fmt: skip
def test_names_of_its_parts_are_taken(change, named):
    with pytest.raises(InputError, match=f"{named}: found the name of a part of the flexible body rod"):
        read_scene(_changed(dict([change])), file=EXAMPLE_SCENES["flexible_slider_crank"])
