"""Solvers declare what they are and which settings they read; what has no effect is told."""

from typing import get_args

import numpy as np
import pytest

import stiffmbs
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve import SOLVERS
from stiffmbs.solve.explicit.projected import TRAITS, solve
from stiffmbs.solve.settings import traits_of
from stiffmbs.solve.solver import FOR_ALL_SOLVERS, Registered, Traits

CHOICES = (
    *({"solver": name} for name in SOLVERS if name != "projected"), {"solver": "bdf", "formulation": "index1"},
    *({"solver": "projected", "scheme": scheme} for scheme in TRAITS),
)  # fmt: skip
OTHER = {
    "formulation": "I3", "stabilisation": 3.0, "scheme": "rk4", "rtol": 1e-3, "atol": 1e-3, "step": 5e-3, "projection": False,
    "max_step": 2e-3, "max_order": 2, "stages": 3,
}  # fmt: skip
"""Another value than the usual one of each setting of solvers."""
SELECTS = {"solver", "formulation", "scheme"}


@pytest.fixture(scope="module")
def cart(examples):
    return stiffmbs.load_scene(examples / "cart_pendulum.yaml")


def names(field):
    """The values that a setting may have."""
    annotation = RunSettings.model_fields[field].annotation
    return {value for given in (get_args(annotation)) for value in (get_args(given) or (given,))} - {type(None)}


def test_every_solver_and_scheme_in_the_settings_is_registered():
    assert names("solver") == set(SOLVERS)
    assert names("scheme") == set(TRAITS)
    assert {name for choice in CHOICES for name in traits_of(RunSettings(**choice)).reads} == set(OTHER)
    assert set(RunSettings.model_fields) == FOR_ALL_SOLVERS | set(OTHER)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("how", CHOICES, ids=str)
def test_settings_have_an_effect_where_the_solver_reads_them(how, examples):
    traits = traits_of(RunSettings(**how))
    scene = stiffmbs.load_scene(examples / ("four_bar.yaml" if traits.exact else "cart_pendulum.yaml"))
    how = {**how, "duration": 0.5, "output": 0.05}
    usual = stiffmbs.run(scene, **how)
    for name, value in OTHER.items():
        if name in SELECTS and name in how:
            continue
        changed = stiffmbs.run(scene, **{**how, name: value})
        same = all(np.array_equal(changed[channel], usual[channel]) for channel in usual)
        unused = traits.switches and name in (
            "formulation",
            "max_order",
            "stages",
        )  # of those that auto does not take here
        assert same == (name not in traits.reads or unused), name
        told = [note for note in changed.notes if "no effect" in note and f"{name} = " in note]
        assert len(told) == (name not in traits.reads), name


def test_projected_chooses_its_steps_and_takes_fixed_ones_where_a_step_is_given(cart):
    how = {"solver": "projected", "duration": 1.0, "points": 11}
    exact = stiffmbs.run(cart, **how, rtol=1e-13)["bar.angle"]
    coarse, fine = (np.abs(stiffmbs.run(cart, **how, rtol=rtol)["bar.angle"] - exact).max() for rtol in (1e-4, 1e-8))
    assert fine < 1e-8 < coarse
    fixed = stiffmbs.run(cart, **how, step=1e-3)
    named = stiffmbs.run(cart, **how, scheme="euler_cromer")
    np.testing.assert_array_equal(fixed["bar.angle"], named["bar.angle"])
    assert fixed.solver["scheme"] == "euler_cromer"
    assert any("rtol = 1e-06 has no effect: euler_cromer reads" in note for note in fixed.notes)


@pytest.mark.parametrize("scheme", ["euler_cromer", "rk4"])
def test_a_step_that_output_points_cut_is_told(cart, scheme):
    how = {"solver": "projected", "scheme": scheme, "duration": 1.0, "output": 0.01}
    for step, taken in ((0.2, "0.01"), (4e-3, "0.00333333"), (5e-3, ""), (1e-3, "")):
        notes = [note for note in stiffmbs.run(cart, **how, step=step).notes if "was reduced" in note]
        assert [note.partition(", ")[0] for note in notes] == [f"step = {step:g} s was reduced to {taken} s"] * bool(
            taken
        )
    unasked = stiffmbs.run(cart, **{**how, "output": 5e-4})
    assert not any("was reduced" in note for note in unasked.notes)


def test_a_solver_is_known_by_its_traits_alone(cart, monkeypatch):
    """Nothing but its entry says that this one takes fixed steps: reruns halve them, presolve leaves its problem alone."""
    mine = Traits("mine", ("step",), fixed_steps=True)

    def solve_mine(dynamics, start, grid, settings, watch):
        chosen = settings.model_copy(update={"scheme": "rk4"})
        return solve(dynamics, start, grid, chosen, watch)

    monkeypatch.setitem(SOLVERS, "auto", Registered(solve_mine, lambda settings: mine))
    found = stiffmbs.verify(cart, duration=0.5, points=11, solver="auto", step=2e-3)
    assert found.presolve == ()
    assert any("mine with steps of 0.001 s and bdf at rtol" in told for told in found.verification)
    assert any("rtol = 1e-06 has no effect: mine reads step" in note for note in found.notes)


@pytest.mark.parametrize("scheme", TRAITS)
def test_a_scheme_given_as_the_solver_is_told_how_it_is_written(scheme):
    with pytest.raises(stiffmbs.InputError, match=f"expected solver: projected, scheme: {scheme}"):
        RunSettings(solver=scheme)
