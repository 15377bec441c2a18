"""Zero is recognised without expansion, and towers of powers take no time."""

import json

import pytest
import sympy as sp

import stiffmbs
from stiffmbs.compile.symbolic.residue import PRIME, residue

x, y = sp.symbols("x y")


@pytest.mark.parametrize(
    ("function", "zero"),
    [
        ((x + y) ** 2 - x**2 - 2 * x * y - y**2, True),
        ((x + y) ** 2 - x**2 - 2 * x * y, False),
        (x / (x + y) + y / (x + y) - 1, True),
        (sp.Float(0.1) * x - sp.Rational(0.1) * x, True),
        (sp.Rational(1, 3) * x - x / 3, True),
        (((x**1000 + 1) ** 1000 + 1) ** 1000, False),
        ((x**1000 + 1) ** 1000 - (x**1000 + 1) ** 999 * (x**1000 + 1) + 0 * y, True),
    ],
)
def test_a_rational_function_is_zero_or_not(function, zero):
    found = residue(function, {x: 3, y: 5})
    assert found is not None and (found == 0) == zero


@pytest.mark.parametrize("function", [sp.sin(x), 2**x, sp.sqrt(x), x ** (y**9), sp.pi * x, 1 / (x - 3), sp.Abs(x)])
def test_other_functions_have_no_residue(function):
    assert residue(function, {x: 3, y: 5}) is None


def test_values_are_those_of_exact_arithmetic():
    function = (x**5 + 7 * y) ** 3 / (2 * x - y)
    exact = function.subs({x: 9, y: 4})
    assert residue(function, {x: 9, y: 4}) == exact.p * pow(exact.q, -1, PRIME) % PRIME


@pytest.mark.parametrize("torque", ["2^(t^9)", "t^t^t^t", "(alpha*t^1000 + 1)^1000 - 1", "1e-3*bar.angle^(10^9)"])
def test_towers_of_powers_are_compiled_at_once(torque):
    bodies = {"bar": {"mass": 1, "inertia": 0.03, "position": [0.3, 0], "markers": {"end": {"point": [-0.3, 0]}}}}
    joints = {"hinge": {"type": "revolute", "i": "bar.end", "j": "ground"}}
    forces = {"f": {"type": "torque", "i": "bar", "torque": torque}}
    scene = {
        "parameters": {"alpha": 1e-300},
        "bodies": bodies,
        "joints": joints,
        "forces": forces,
        "run": {"duration": 0.01},
    }
    assert stiffmbs.run(stiffmbs.read_scene(json.dumps(scene))).outcome.name == "DONE"
