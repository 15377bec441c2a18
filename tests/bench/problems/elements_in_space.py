"""Every kind of joint and force in space: residual and Jacobian of one element, and how long its first compilation takes."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, replace

import numpy as np

from stiffmbs.analyses.warm import usual_elements
from stiffmbs.cache.entries import DIRECTORY_VARIABLE
from stiffmbs.compile.compile_model import compile_model
from stiffmbs.compile.group import Group
from stiffmbs.compile.kind import sorted_out
from stiffmbs.compile.record import compile_kind
from stiffmbs.compile.state import State
from stiffmbs.compile.system import System

from ..benchmark import Row

COPIES, ROUNDS = 1000, 50
COLD = "from tests.bench.problems.elements_in_space import compile_first; print(compile_first({element!r}))"


def compile_first(element: str) -> float:
    """Seconds of processor time to derive and compile one of the usual elements; SymPy and LLVM are imported before."""
    import llvmlite.binding  # noqa: F401
    import sympy  # noqa: F401

    scene = usual_elements(3).data()
    begun = time.process_time()
    kind, _ = sorted_out(element, {**scene.joints, **scene.forces}[element].at_initial_pose(scene), scene)
    compile_kind(kind)
    return time.process_time() - begun


def _copied(system: System, element: str) -> System:
    """A system of many copies of one element, whose values nothing is done with."""
    group = next(group for group in system.groups if element in group.names)
    at, count = group.names.index(element), group.record.n_equations
    numbers = group.numbers.copy()
    copies = Group(
        group.kind, group.record, group.of_body, (element,) * COPIES, [group.elements[at]] * COPIES,
        np.repeat(group.index[at : at + 1], COPIES, axis=0), numbers, 0,
    )  # fmt: skip
    equations = ((element, "copy"),) * (COPIES * count)
    rows = np.ones(len(equations), dtype=bool)
    return replace(system, groups=(copies,), equations=equations, holonomic=rows, active=rows)


def _each(state: State, term_set: str) -> float:
    """Seconds to evaluate a term set for one element: the least of many, over all copies."""
    state.evaluate(term_set, 0.0)
    times = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        state.evaluate(term_set, 0.0)
        times.append(time.perf_counter() - begun)
    return min(times) / COPIES


@dataclass(frozen=True)
class ElementInSpace:
    """One of the usual elements in space."""

    element: str

    @property
    def name(self) -> str:
        return f"in_space_{self.element}"

    def measured(self) -> list[Row]:
        """Time of a residual, with what a Jacobian and the first compilation take beside it."""
        with tempfile.TemporaryDirectory() as empty:
            program = [sys.executable, "-c", COLD.format(element=self.element)]
            told = subprocess.run(
                program, capture_output=True, text=True, env={**os.environ, DIRECTORY_VARIABLE: empty}
            )
        return [self._row(f", first compiled in {float(told.stdout):.1f} s")]

    def glanced(self) -> list[Row]:
        """The same without the first compilation."""
        return [self._row("")]

    def _row(self, told: str) -> Row:
        state = State(_copied(compile_model(usual_elements(3).data()), self.element))
        residual, jacobian = _each(state, "motion"), _each(state, "tangent")
        times = f"residual {residual * 1e6:.3f} us, Jacobian {jacobian * 1e6:.3f} us"
        return Row(self._kind(), times + told, 0.0, residual, False)

    def _kind(self) -> str:
        scene = usual_elements(3).data()
        return {**scene.joints, **scene.forces}[self.element].kind


def _elements() -> list[str]:
    scene = usual_elements(3).data()
    return [*scene.joints, *scene.forces]


BENCHMARKS = tuple(map(ElementInSpace, _elements()))
