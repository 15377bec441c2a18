"""Requests that read the channels of tyres."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError

WHEEL = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  wheel: {mass: 350, inertia: [12, 2, 12], position: [0, 0, 0.33], velocity: [10, 0, 0], omega: [0, 30, 0]}
forces:
  tyre: {type: fiala_tyre, i: wheel, radius: 350 mm, stiffness: 200 N/mm, damping: 800, slip_stiffness: 80 kN,
         cornering_stiffness: 60000, mu_static: 1, mu_sliding: 0.8, relaxation: [30 cm, 50 cm]}
requests:
  grip: tyre.longitudinal/tyre.load
  squeezed: tyre.deflection + 1 mm
  patch: tyre.deflection_x/30 cm
  worst: max(tyre.load - 3 kN, 0)
  sum: REQUEST
run: {duration: 0.2 s, output: 10 ms}
"""


def test_formulas_of_loads_slips_and_deflections():
    found = stiffmbs.run(stiffmbs.read_scene(WHEEL.replace("REQUEST", "tyre.load + tyre.lateral")))
    assert found["grip"] == pytest.approx(found["tyre.longitudinal"] / found["tyre.load"])
    assert found["squeezed"] == pytest.approx(found["tyre.deflection"] + 1e-3)
    assert found["patch"] == pytest.approx(found["tyre.slip"], abs=1e-9)
    assert found["worst"] == pytest.approx(np.maximum(found["tyre.load"] - 3000, 0))
    assert (found.unit("squeezed"), found.unit("worst"), found.unit("grip")) == ("m", "N", "")


@pytest.mark.parametrize(
    ("formula", "sentence"),
    [
        ("tyre.load + 1 mm", "found N and m"),
        ("tyre.deflection_z", "expected one of tyre.fx, .* tyre.load, .* tyre.deflection_y"),
    ],
)
def test_what_does_not_fit_is_told(formula, sentence):
    with pytest.raises(InputError, match=sentence):
        stiffmbs.read_scene(WHEEL.replace("REQUEST", formula))
