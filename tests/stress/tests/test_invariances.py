"""Scenes that are turned, moved, scaled, split or renamed move alike, and what moves otherwise is found."""

from dataclasses import replace

import numpy as np
import pytest

from stiffmbs.errors import SolverError
from tests.stress.case import Outcome
from tests.stress.fuzzers import extended, invariances
from tests.stress.invariance import bodies, similarity, ways
from tests.stress.invariance.balance import balance
from tests.stress.invariance.change import Change
from tests.stress.invariance.comparison import bars_of
from tests.stress.invariance.typed import NotLegitimate
from tests.stress.random_scenes.features import SMOOTH
from tests.stress.random_scenes.scene import random_scene

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

BDF = {"solver": "bdf"}


def test_random_scenes_move_alike(every):
    for seed in every(range(5), 3):
        verdict = invariances.trial(seed)
        assert verdict.outcome in (Outcome.RIGHT, Outcome.TOLD), verdict


def test_rounding_of_accelerations_at_rest_is_no_difference():
    """A beam at rest without forces: 4e-9 rad/s^2 would change its angular velocity by 6e-11 rad/s between two outputs."""
    assert extended.trial(6002008).outcome is Outcome.RIGHT


@pytest.fixture(scope="module", params=[2, 3])
def original(request):
    content = invariances.assembled(random_scene(np.random.default_rng(1), request.param, SMOOTH))
    fine, coarse = (ways.at_once(content, **BDF, rtol=rtol) for rtol in (invariances.FINE, invariances.COARSE))
    return invariances.Original(content, BDF, fine, bars_of(fine, coarse))


@pytest.mark.sampled(15)
@pytest.mark.parametrize("name", invariances.WAYS)
def test_each_change_leaves_the_motion(original, name):
    try:
        gap = invariances.difference_of(original, name, np.random.default_rng(2))
    except NotLegitimate as reason:
        pytest.skip(str(reason))
    assert gap.ratio <= 1


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("section", "field", "factor"), [("gravity", 0, 1.001), ("bodies", "mass", 1.001), ("bodies", "inertia", 1.01)]
)
def test_another_motion_is_found(original, monkeypatch, section, field, factor):
    content = original.content
    if section == "gravity":
        changed = {**content, "gravity": [factor * part + 1e-3 for part in content["gravity"]]}
    else:
        bodies = {name: {**body, field: _times(body[field], factor)} for name, body in content["bodies"].items()}
        changed = {**content, "bodies": bodies}
    monkeypatch.setitem(invariances.WAYS, "wrong", lambda content, rng: (Change("wrong", changed), ways.at_once))
    assert invariances.difference_of(original, "wrong", np.random.default_rng(0)).ratio > 1


def _times(value, factor):
    return (factor * np.array(value)).tolist()


def test_random_scenes_keep_the_momentum_of_each_body(original):
    gap = balance(original.content, original.fine)
    assert gap.channel
    assert gap.ratio <= 1


@pytest.mark.sampled(5)
@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_two_halves_of_a_body_are_one_again(dimensions, seed):
    rng = np.random.default_rng(seed)
    content = invariances.assembled(random_scene(rng, dimensions, SMOOTH))
    halves = bodies.with_a_body_in_two(content, rng).content
    found = ways.at_once(halves, **BDF, rtol=invariances.FINE)
    bars = bars_of(found, ways.at_once(halves, **BDF, rtol=invariances.COARSE))
    original = invariances.Original(halves, BDF, found, bars)
    assert invariances.difference_of(original, invariances.RARE, rng).ratio <= 1


MERGED = {
    "dimensions": 3, "gravity": [0, 0, -9.81], "run": {"duration": 0.3, "points": 21},
    "bodies": {
        "a": {"mass": 1.2, "inertia": [[0.35, 0.03, 0.01], [0.03, 0.4, 0.02], [0.01, 0.02, 0.45]], "omega": [3.0, -4.0, 5.0]},
        "b": {"mass": 2.0, "inertia": [0.3, 0.45, 0.5], "position": [0.5, 0.3, 0.2], "omega": [3.0, -4.0, 5.0]},
    },
    "joints": {
        "pin": {"type": "spherical", "i": {"body": "a", "point": [-0.4, 0.1, 0.0]}, "j": {"body": "ground", "point": [-0.4, 0.1, 0.0]}},
        "weld": {"type": "fixed", "i": "b", "j": {"body": "a", "point": [0.5, 0.3, 0.2]}},
    },
    "forces": {
        "bush": {
            "type": "bushing", "i": {"body": "ground", "point": [0.6, 0.3, 0.4]}, "j": {"body": "b", "point": [0.2, 0.0, 0.1]},
            "stiffness": [300.0, 200.0, 100.0, 5.0, 6.0, 7.0], "damping": [5.0, 4.0, 3.0, 0.1, 0.2, 0.3],
        },
    },
}  # fmt: skip
"""A fixed pair of bodies that spins fast, on a bushing that is fixed to the ground by its first marker."""


@pytest.mark.parametrize("presolve", [True, False])
def test_a_fixed_pair_keeps_the_momentum_of_each_body(presolve):
    assert balance(MERGED, ways.at_once(MERGED, **BDF, presolve=presolve)).ratio <= 1


def test_velocities_that_do_not_integrate_the_accelerations_are_found():
    found = ways.at_once(MERGED, **BDF)
    changed = replace(found, channels={**found.channels, "b.wx": found.channels["b.wx"] * (1 + 0.2 * found.time)})
    assert balance(MERGED, changed).ratio > 1


def test_a_driven_coordinate_keeps_its_dimension():
    drive = {"type": "drive", "coordinate": "b.x", "velocity": "cos(3*t)"}
    content = {
        "bodies": {"b": {"mass": 1.0, "inertia": 1.0, "velocity": [1.0, 0.0]}}, "joints": {"drive": drive},
        "run": {"duration": 1.0, "points": 11},
    }  # fmt: skip
    change = similarity.scaled(content, similarity.Units(3.0, 0.2, 1.5))
    found = ways.at_once(change.content, **BDF)
    expected = ways.at_once(content, **BDF).channels["drive.fx"]
    assert change.back(found.channels, found.time)["drive.fx"] == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("channel", ["a.q1", "a.wdx", "b.wy", "weld.tz", "pin.fx", "bush.ty", "b.ay"])
def test_another_sign_of_a_channel_breaks_the_balance_of_momentum(channel):
    found = ways.at_once(MERGED, **BDF)
    changed = replace(found, channels={**found.channels, channel: -found.channels[channel]})
    assert balance(MERGED, changed).ratio > 1


def test_a_stop_of_a_changed_run_is_wrong_unless_the_settings_stop_the_original(original, monkeypatch):
    def stopping(content, **how):
        raise SolverError("stopped")

    monkeypatch.setitem(invariances.WAYS, "wrong", lambda content, rng: (Change("wrong", content), stopping))
    rng, other = np.random.default_rng(0), {"solver": "auto"}
    assert invariances.difference_of(original, "wrong", rng).ratio == np.inf
    assert invariances.difference_of(original, "wrong", rng, other).ratio == np.inf
    monkeypatch.setitem(invariances.WAYS, "moved by 1 km", invariances.WAYS["wrong"])
    assert invariances.difference_of(original, "moved by 1 km", rng, other).ratio == np.inf
    assert invariances.difference_of(original, "moved by 1 km", rng, {**BDF, "formulation": "I3"}).ratio == 0
    monkeypatch.setattr(ways, "at_once", stopping)
    assert invariances.difference_of(original, "wrong", rng, other).ratio == 0
