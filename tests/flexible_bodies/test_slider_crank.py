"""Flexible slider-crank (Simeon, 1996; problem 'crank' of the IVP test set) against equations in minimal coordinates."""

import numpy as np
import pytest
from skfem import MeshHex, MeshHex2
from skfem.io.meshio import to_meshio

from stiffmbs import read_scene, run

from ..conftest import EXAMPLE_SCENES

HEIGHT, LENGTH = 0.008, 0.3
DEFLECTION = {0.04: -1.100445e-3, 0.08: -1.813306e-3, 0.1: -1.38890e-4}
"""Deflection of the middle of the rod from its chord, m, by time, from an undeformed rod with linear strains.

By integration of Simeon's equations with two bending modes, relative tolerance 1e-11.
"""
ANGLE = -0.33119284
"""Angle of the rod at 0.1 s, rad."""


@pytest.mark.long
def test_the_rod_of_a_slider_crank_bends_as_a_beam(tmp_path):
    """The equations are those of Euler and Bernoulli; a stiffer modulus compensates shear and rotary inertia of the solid."""
    width = 1e3 * np.linspace(-HEIGHT / 2, HEIGHT / 2, 2)
    cells = MeshHex.init_tensor(1e3 * np.linspace(0, LENGTH, 31), width, width)
    to_meshio(MeshHex2.from_mesh(cells)).write(tmp_path / "flexible_rod.vtu")
    shear = 2 * 1.3 / 0.85  # E/(k G), Cowper's factor for a square
    stiffer = 1 + np.pi**2 * HEIGHT**2 / (12 * LENGTH**2) * (1 + shear)
    changes = {
        "E: 200 GPa": f"E: {200 * stiffer} GPa",
        "zeta: 0.02": "zeta: 0",
        "modes: 4": "modes: 4\n    stiffening: false",
        "      slider_end: {plane": "      middle: {plane: {point: [l2/2, 0, 0], normal: [1, 0, 0]}, type: average}\n      slider_end: {plane",
        "output: 20 us, rtol: 1e-6": "points: 6, rtol: 1e-7",
    }
    text = EXAMPLE_SCENES["flexible_slider_crank"].read_text()
    for old, new in changes.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    found = run(read_scene(text, file=tmp_path / "crank.yaml"))
    start, middle, end = (
        np.array([found[f"rod.{name}.{axis}"] for axis in "xy"]) for name in ("crank_end", "middle", "slider_end")
    )
    chord, arm = end - start, middle - start
    deflection = (chord[0] * arm[1] - chord[1] * arm[0]) / np.hypot(*chord)
    expected = list(DEFLECTION.values())
    assert deflection[np.searchsorted(found.t, np.array(list(DEFLECTION)) - 1e-9)] == pytest.approx(
        expected, abs=0.01 * np.abs(expected).max()
    )
    assert found["rod_angle"][-1] == pytest.approx(ANGLE, abs=5e-5)  # a free axial vibration of the rod remains
