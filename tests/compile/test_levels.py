"""Kernels: level of optimisation, and kernels shared by sets of terms."""

import numpy as np
import pytest
import sympy as sp

from stiffmbs.cache import entries
from stiffmbs.compile.compile_model import compile_model
from stiffmbs.compile.machine import compiler, drafts, object_code
from stiffmbs.compile.record import source_of
from stiffmbs.compile.symbolic.derive import _vanishes
from stiffmbs.compile.terms import KERNEL_SIGNATURE
from stiffmbs.model.read_scene import read_scene

BUSHING = """
dimensions: 3
bodies: {a: {mass: 1, inertia: [1, 1, 1]}, b: {mass: 1, inertia: [1, 1, 1]}}
forces: {bush: {type: bushing, i: a, j: b, stiffness: [1e5, 2e5, 3e5, 1, 2, 3], damping: [10, 20, 30, 0.1, 0.2, 0.3]}}
"""


@pytest.fixture(scope="module")
def system():
    return compile_model(read_scene(BUSHING))


def bushings(system):
    """Return the number of the bushings' group, and the group."""
    return next((g, group) for g, group in enumerate(system.groups) if "bush" in group.names)


@pytest.mark.long
def test_results_do_not_depend_on_the_level_of_optimisation(system, monkeypatch, tmp_path):
    """To the last digit: a run does not change with the level at which its kernels are compiled."""
    monkeypatch.setattr(drafts, "object_code", object_code.object_code)  # other tests compile at lower levels
    monkeypatch.setenv(entries.DIRECTORY_VARIABLE, str(tmp_path))
    compiled = compiler.compiled_source.__wrapped__
    g, group = bushings(system)
    rng = np.random.default_rng(1)
    q, u = rng.normal(size=system.n_q + 7), rng.normal(size=system.n_u + 6)
    others, turn = np.zeros(40), rng.normal(size=200)
    for term_set in ("motion", "tangent", "output"):
        values = []
        for level in (object_code.FULL, object_code.SHORT, object_code.DRAFT):
            kernel = compiled(source_of(group.kind, term_set), "kernel", KERNEL_SIGNATURE, level=level)
            found = np.zeros(system.n_values(term_set))
            arrays = (q, turn, u, others, others, others, system.places[term_set][g], found)
            kernel.call(group.count, group.index.ctypes.data, group.numbers.ctypes.data, 0.3, *(x.ctypes.data for x in arrays))  # fmt: skip
            values.append(found)
        assert np.count_nonzero(values[0]) > 6
        np.testing.assert_array_equal(values[0], values[1])
        np.testing.assert_array_equal(values[0], values[2])


def test_forces_have_one_kernel_for_motion_and_acceleration(system):
    """It is compiled once, which takes most of the time of a first run."""
    _, group = bushings(system)
    assert source_of(group.kind, "motion") == source_of(group.kind, "acceleration")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a*(b - c) + b*(c - a) + c*(a - b)", True),
        ("(a + b)**2 - a**2 - 2*a*b - b**2", True),
        ("a*(b - c) + b*(c - a) + c*(a - b) + a", False),
        ("(a - 3)*(b - 5)*c", False),
        ("sqrt(a**2)*0 + sqrt(a)*sqrt(b) - sqrt(a*b)", False),
    ],
)
def test_powers_that_cancel_are_zero(text, expected):
    """Also if a factor is zero at the numbers that are tried first."""
    assert _vanishes(sp.sympify(text)) == expected


def test_the_cache_of_the_tests_is_its_own():
    """Entries of a run and of a test have the same names, but other levels of optimisation."""
    assert drafts.object_code is not object_code.object_code
    assert entries.cache_directory().name == "tests"
