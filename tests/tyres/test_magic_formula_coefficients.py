"""Every coefficient of the Magic Formula against an independent implementation, at random tyres and states."""

from types import SimpleNamespace

import numpy as np
import pytest

from stiffmbs.elements.tyres.coefficients import WRENCH
from stiffmbs.elements.tyres.magic_formula import relaxation_lengths
from stiffmbs.elements.tyres.names import COEFFICIENTS, SCALES
from stiffmbs.tyres import TyreProperties

from .plain_magic_formula import plain_relaxation_lengths, plain_wrench

OF_LENGTHS = ("PTX1", "PTX2", "PTX3", "PTY1", "PTY2", "LSGKP", "LSGAL")
TOLERANCE = 1e-11
SIZES = {
    "PCX1": 1.6, "PDX1": 1.1, "PKX1": 21.0, "PKX3": 0.2, "PCY1": 1.3, "PDY1": 1.0, "PKY1": -14.0, "PKY2": 1.8, "QBZ1": 9.0,
    "QCZ1": 1.1, "QDZ1": 0.1, "RBX1": 8.0, "RBX2": 6.0, "RCX1": 1.0, "RBY1": 7.0, "RBY2": 5.0, "RCY1": 1.0, "RVY4": 8.0,
    "RVY5": 1.9, "RVY6": 12.0, "QBZ9": 10.0, "PTY2": 1.8, "PTX1": 2.0, "PTY1": 2.0,
}  # fmt: skip
"""About which coefficients are drawn; others about zero."""

EVEN = ("PCX1", "PCY1", "LCX", "LCY", "LGAX", "RBX1", "RBX2", "RCX1", "LXAL", "RBY1", "RBY2", "RCY1", "LYKA", "RVY4")
"""Forces do not depend on their signs, as B C = K/D, or as they stand in a cosine."""


def random_tyre(seed):
    """All coefficients and scale factors, none at a value where it has no effect."""
    rng = np.random.default_rng(seed)
    found = {"FNOMIN": 4000.0, "UNLOADED_RADIUS": 0.32, "VERTICAL_STIFFNESS": 2e5, "LONGVL": 16.0}
    for name in COEFFICIENTS:
        small = rng.choice([-1, 1]) * rng.uniform(0.02, 0.2)
        found[name] = SIZES[name] * rng.uniform(0.8, 1.2) if name in SIZES else small
    return found | {name: rng.uniform(0.8, 1.2) for name in SCALES}


def random_states(seed, count=60):
    rng = np.random.default_rng(seed)
    return np.column_stack(
        [
            rng.uniform(1000, 8000, count), rng.uniform(-0.3, 0.3, count), rng.uniform(-0.3, 0.3, count),
            rng.uniform(-0.15, 0.15, count), rng.uniform(0.2, 2.5, count),
        ]
    )  # fmt: skip


def by_plain(tyre, states):
    """Forces and torques, and relaxation lengths, a row for each state."""
    return np.array([(*plain_wrench(tyre, *s), *plain_relaxation_lengths(tyre, s[0], s[3])) for s in states])


def by_package(tyre, states):
    load, kappa, alpha, gamma, ratio = states.T
    found = TyreProperties(coefficients=tyre).wrench(load, kappa, alpha, gamma, ratio * tyre["LONGVL"])
    lengths = [[float(x) for x in relaxation_lengths(SimpleNamespace(**tyre), s[0], s[3], lambda x: x)] for s in states]
    return np.column_stack([*(found[name] for name in WRENCH), np.array(lengths)])


def difference(one, other):
    """The largest difference, as a part of the largest value of its column."""
    return (np.abs(one - other) / np.abs(other).max(axis=0)).max()


@pytest.mark.long
@pytest.mark.sampled(12)
@pytest.mark.parametrize("seed", range(12))
def test_forces_and_torques_of_random_tyres(seed):
    tyre, states = random_tyre(seed), random_states(seed + 100)
    assert difference(by_package(tyre, states), by_plain(tyre, states)) < TOLERANCE


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", [*COEFFICIENTS, *SCALES])
def test_the_sign_of_each_coefficient_is_seen(name):
    """The comparison above fails where one sign is wrong: the other sign of a number is far beyond its tolerance, or where
    the forces are even in it, another value."""
    tyre, states = random_tyre(0), random_states(100)
    turned = {**tyre, name: (0.7 if name in EVEN else -1) * tyre[name]}
    assert difference(by_plain(turned, states), by_plain(tyre, states)) > 1e4 * TOLERANCE
