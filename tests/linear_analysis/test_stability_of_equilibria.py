"""Stability of equilibria at rest by eigenvalues, and forces that vanish there."""

import pytest

import stiffmbs
from tests.stress.families.analyses.flutter import LAWS, LOADS, column, slider


@pytest.mark.parametrize(("law", "unstable"), LAWS.items())
def test_a_slider_with_negative_damping_is_called_unstable(law, unstable):
    assert any("unstable" in note for note in stiffmbs.equilibrium(slider(law)).notes) == unstable


@pytest.mark.parametrize(("given", "unstable"), LOADS.items())
def test_zieglers_column_flutters_above_its_critical_load(given, unstable):
    found = stiffmbs.equilibrium(column(*given))
    assert any("unstable: disturbances grow" in note and "oscillate" in note for note in found.notes) == unstable


def test_an_equilibrium_too_large_for_eigenvalues_says_so(monkeypatch):
    monkeypatch.setattr("stiffmbs.analyses.settled.MOST_FOR_EIGENVALUES", 2)
    notes = stiffmbs.equilibrium(slider("-100*b.x + 2*b.vx")).notes
    assert notes == (
        "the dynamic stability of the equilibrium was not checked: the model has 3 velocities, more than 2",
    )


def test_forces_with_a_potential_need_no_eigenvalues(monkeypatch):
    monkeypatch.setattr("stiffmbs.analyses.settled.MOST_FOR_EIGENVALUES", 2)
    assert not stiffmbs.equilibrium(slider("-100*b.x")).notes


def test_a_force_that_vanishes_cubically_has_an_equilibrium():
    found = stiffmbs.equilibrium(slider("-b.x^3"))
    assert found.channels["b.x"] == pytest.approx(0, abs=1e-3)
    assert found.imbalance == 0


def test_a_slider_without_any_force_is_named():
    found = stiffmbs.equilibrium(slider("0"))
    assert found.free == ("b.vx",) and "no force determines b.vx" in found.notes[0]


@pytest.mark.parametrize(
    ("law", "unstable"),
    [
        ("30*max(b.x - 0.1, 0) - 40*min(b.x - 0.1, 0)", True),
        ("-30*max(b.x - 0.1, 0) - 40*min(b.x - 0.1, 0)", False),
        ("-100*b.x + 2*max(b.vx, 0)", True),
        ("-100*b.x - 2*max(b.vx, 0) - 3*min(b.vx, 0)", False),
    ],
)
def test_stability_on_a_breakpoint_is_that_of_both_sides(law, unstable):
    notes = stiffmbs.equilibrium(slider(law)).notes
    assert any("unstable on one side of a breakpoint of a force on b.vx" in note for note in notes) == unstable, notes


def test_an_equilibrium_is_not_unstable_because_the_states_beside_it_are():
    """At x = 0 the force x y in y has no stiffness; beside the breakpoint of the damper it has one of either sign."""
    model = stiffmbs.Model(gravity=(0, 0))
    model.add("b", stiffmbs.Body(mass=1, inertia=1))
    model.add("f", stiffmbs.AppliedForce(i="b", force=["-100*b.x - 2*max(b.vx, 0) - 3*min(b.vx, 0)", "b.x*b.y"]))
    found = stiffmbs.equilibrium(model)
    assert found.free == ("b.vy", "b.omega")
    assert not any("unstable" in note for note in found.notes), found.notes


def test_dry_friction_at_rest_has_no_linearisation():
    (note,) = stiffmbs.equilibrium(slider("-100*b.x - 5*sign(b.vx)")).notes
    assert "not checked: a force or rate of b.vx is discontinuous" in note
    assert "sign(v) at rest can hold many poses" in note
