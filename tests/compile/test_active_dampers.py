"""Dampers whose force adds energy are noted by `check` and `run`, with the range; others are not."""

import json

import pytest

import stiffmbs

BODIES = {2: {"mass": 1, "inertia": 1, "position": [1, 0]}, 3: {"mass": 1, "inertia": [1, 1, 1], "position": [1, 0, 0]}}


def notes(kind, dimensions=2, **fields):
    force = {"type": kind, "i": "a", "j": "ground", **fields}
    scene = {
        "dimensions": dimensions,
        "bodies": {"a": BODIES[dimensions]},
        "forces": {"f": force},
        "run": {"duration": 0.01},
    }
    model = stiffmbs.read_scene(json.dumps(scene))
    found, of_run = (
        [note for note in each if "adds energy" in note]
        for each in (stiffmbs.check(model).messages, stiffmbs.run(model).notes)
    )
    assert found == of_run
    return found


DROOPING = [[-1, -100], [0, 0], [0.5, 80], [1, -20]]


@pytest.mark.parametrize(
    "fields",
    [
        {"damping": 20}, {"damper_law": {"table": [[-1, -100], [0, 0], [1, 100]]}},
        {"damper_law": {"table": [[-1, 50], [0, 60], [1, 70]]}},  # a constant part, as of the gas in a damper
        {"damper_law": {"table": [[-1, -50], [-0.01, -60], [0.01, 60], [1, 50]]}},  # friction that falls with the rate
        {"damper_law": {"table": [[0.1, 60], [1, 50]]}}, {"damper_law": {"table": DROOPING}, "damping": 25},
    ],
)  # fmt: skip
def test_passive_dampers_have_no_note(fields):
    assert notes("spring_damper", **fields) == []


def test_a_damper_that_adds_energy_is_noted_with_its_range():
    (note,) = notes("spring_damper", damping=-20)
    assert note.startswith("f: its damping is negative, -20,")
    (note,) = notes("spring_damper", damper_law={"table": DROOPING, "lines": True})
    assert "between v = 0.9" in note
    assert "and 1 m/s, within its own range of -1 to 1 m/s" in note
    scene = {
        "dimensions": 2, "bodies": {"a": BODIES[2]}, "tables": {"curve": {"table": DROOPING}},
        "forces": {"f": {"type": "spring_damper", "i": "a", "j": "ground", "damper_law": "curve(v)"}},
    }  # fmt: skip
    assert any(
        "the table of its damper_law" in note
        for note in stiffmbs.check(stiffmbs.read_scene(json.dumps(scene))).messages
    )
    (note,) = notes("torsion_spring", damper_law={"table": [[0, 0], [2, -70]]})
    assert "and 2 rad/s" in note


PASSIVE = (
    "20*v", "60*tanh(v/0.01)", "60 + 20*v", "20*v - v^3", "max(100*v, 20*v)", "20 mN*sign(v)*sqrt(abs(v)/(1 m/s))",
)  # fmt: skip
"""The force of a fitted cubic has the wrong sign at rates of no interest."""


@pytest.mark.parametrize("law", PASSIVE)
def test_formulas_of_the_rate_that_damp_have_no_note(law):
    assert notes("spring_damper", damper_law=law) == []


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("law", "rates"),
    [
        ("-2*v", "negative and positive"), ("-2*v + v^3", "negative and positive"), ("60 - 20*v", "negative and positive"),
        ("min(20*v, -10*v)", "positive"), ("-2*max(v - 0.1, 0)", "positive"), ("-60*tanh(v/0.01)", "negative and positive"),
    ],
)  # fmt: skip
def test_a_formula_of_the_rate_that_adds_energy_is_noted(law, rates):
    """Only coefficients and tables were judged."""
    (note,) = notes("spring_damper", damper_law=law)
    assert note.startswith(f"f: its damper_law '{law}' has the wrong sign at {rates} rates")
    assert notes("torsion_spring", damper_law=law)
    assert notes("spring_damper", damper_law="-2*v", damping=3) == []


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("dimensions", "damping", "where"),
    [
        (2, [1, 2, 3], ""), (2, [[4, 2, 0], [2, 1, 0], [0, 0, 1]], ""), (3, [1, 1, 1, 0, 0, 0], ""),
        (2, [1, -2, 3], "component 2"), (2, [[1, 2, 0], [2, 1, 0], [0, 0, 1]], "coupled motions"),
        (3, [1e5, 1e5, 1e5, 1, 1, -1], "component 6"),
    ],
)  # fmt: skip
def test_a_damping_matrix_is_noted_if_it_is_not_positive(dimensions, damping, where):
    stiffness = [1.0] * (3 if dimensions == 2 else 6)
    found = notes("bushing", dimensions, stiffness=stiffness, damping=damping)
    assert [where in note for note in found] == ([True] if where else [])
