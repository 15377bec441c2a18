"""Newton's iteration with falsified matrices: motions are right, or steps are shorter, but no wrong result is accepted."""

import ctypes

import numpy as np
import pytest

import stiffmbs
from stiffmbs.solve.radau import memory
from stiffmbs.solve.radau.native.layouts import RADAU

FRACTION = 0.2
"""Fraction of the matrices that are falsified."""
SETUP = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_int64, ctypes.c_int64)


class Falsifier:
    """Falsification of the matrices of one step, real and complex, before they are factored.

    `change(values, old, self, random)` returns the falsified entries; `old` are those of the first matrix.
    """

    def __init__(self, change, formula, seed):
        arrays, solvers = formula._kept
        self.rows, self.columns = formula._equations.pattern
        self.diagonal = self.rows == self.columns
        self._change, self._random = change, np.random.default_rng(seed)
        self._places = [
            [np.arange(len(self.rows))] if k == 0 else [arrays["re_re"], arrays["im_im"]] for k in range(len(solvers))
        ]
        self._imaginary = [arrays["im_re"], arrays["re_im"]]
        self._numbers = {solver.solver: k for k, solver in enumerate(solvers)}
        self._values = [
            np.ctypeslib.as_array((ctypes.c_double * (1 + int(max(place.max() for place in places)))).from_address(int(at)))
            for places, at in zip(self._places, arrays["values"], strict=True)
        ]  # fmt: skip
        self._original, self._old, self.count = SETUP(arrays["setup"]), {}, 0
        self.routine = SETUP(self._set_up)

    def _set_up(self, solver, matrix):
        k = self._numbers[solver]
        values = self._values[k]
        if k == 0:
            self._now = self._random.random() < FRACTION
            self._draw = self._random.integers(0, 2**31)
            self.count += self._now
        if self._now:
            for place in self._places[k]:
                old = self._old.get(k, values[place])
                values[place] = self._change(values[place], old, self, np.random.default_rng(self._draw))
            if self._change is scaled_by_half and k > 0:
                for place in self._imaginary:
                    values[place] *= 0.5
        self._old.setdefault(k, values[self._places[k][0]].copy())
        return self._original(solver, matrix)


def scaled_by_half(values, old, of, random):
    return 0.5 * values


def wrong_block(values, old, of, random):
    """Entries of three rows and columns vanish, without those of the diagonal."""
    while True:
        row, column = random.integers(0, of.rows.max() + 1, 2)
        inside = (of.rows // 3 == row // 3) & (of.columns // 3 == column // 3) & ~of.diagonal
        if inside.any():
            return np.where(inside, 0.0, values)


def of_the_start(values, old, of, random):
    """Entries off the diagonal, which do not depend on the step, are those of the first matrix."""
    return np.where(of.diagonal, values, old)


@pytest.fixture
def falsified(monkeypatch):
    """Return a function that runs radau with falsified matrices, and the number of these."""

    def run(scene, change, seed, **settings):
        found = []
        connect = memory.Radau.connect

        def connected(formula, *given):
            connect(formula, *given)
            found.append(Falsifier(change, formula, seed))
            formula._words[list(RADAU).index("setup")] = ctypes.cast(found[-1].routine, ctypes.c_void_p).value

        with monkeypatch.context() as patch:
            patch.setattr(memory.Radau, "connect", connected)
            solution = stiffmbs.run(scene, solver="radau", **settings)
        return solution, sum(each.count for each in found)

    return run


SCENES = {
    "cart_pendulum": ([], {"duration": 3.0}, ["bar.angle", "cart.x"]),
    "half_car": ([("k_b", "1e7 N/m")], {}, ["chassis.y", "chassis.x", "front.angle"]),
}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("change", [scaled_by_half, wrong_block, of_the_start])
@pytest.mark.parametrize("name", SCENES)
def test_no_wrong_result_is_accepted_with_a_wrong_matrix(examples, falsified, name, change):
    changes, settings, channels = SCENES[name]
    scene = stiffmbs.load_scene(examples / f"{name}.yaml", changes)
    exact = stiffmbs.run(scene, rtol=1e-9, solver="radau", **settings)
    total = 0
    for seed in range(10):
        found, count = falsified(scene, change, seed, rtol=1e-5, **settings)
        total += count
        assert found.success
        for channel in channels:
            np.testing.assert_allclose(found[channel], exact[channel], atol=1e-4, err_msg=f"{channel}, seed {seed}")
    assert total > 30
