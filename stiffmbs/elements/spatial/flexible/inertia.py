"""Inertia and elasticity of a flexible body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from ....reading.marker import MarkerReference
from ...element import CompiledTerms, Force
from .bodies import FloatingFrame
from .layout import BODY, work_size

MACHINE = "stiffmbs.compile.machine"

KERNELS = {
    "inertia": ("add_forces", "add_inertia", "kinetic_energy", "potential_energy", "dissipated_power"),
    "slopes": ("add_force_slopes", "add_inertia_slopes"),
    "sums": ("take_sums",),
}
"""Compiled functions by their modules."""
CALLS = {
    "f": "add_forces({n}, own, own, row, turned, u, work, f)",
    "inertia": "add_inertia({n}, own, turned, work, inertia)",
    "potential": "potential[0] = potential_energy({n}, own, own, turned, work)",
    "power": "power[0] = dissipated_power({n}, own, work)",
    "kinetic": "kinetic[0] = kinetic_energy({n}, own, row, turned, u, work)",
    "f_q": "add_force_slopes({n}, own, row, turned, u, work, f_q, f_u)",
    "inertia_q": "add_inertia_slopes({n}, own, row, turned, a, work, inertia_q)",
}
"""Computation of the terms in this order; that of f_u is part of that of f_q."""


class FlexibleInertia(Force):
    """Inertia, elasticity, damping and weight of a flexible body, without those of the rigid frame.

    The equations are those of the nodal-based floating frame with all quadratic velocity terms (Zwoelfer & Gerstmayr,
    Multibody System Dynamics 51, 2021). They are sums over constant arrays in compiled loops, created by the model,
    hence without a kind.
    """

    kind: ClassVar[str] = ""

    numbers: Any
    i: MarkerReference
    modes: tuple[MarkerReference, ...]

    @classmethod
    def compiled_terms(cls, kind: Any) -> CompiledTerms:
        """Return the patterns of the terms and the sources of the kernels for 3 modal coordinates in each body but one."""
        n_bodies = kind.n_bodies
        n = 3 * (n_bodies - 1)
        angular, velocities = [3, 4, 5], [6 * (1 + k // 3) + k % 3 for k in range(n)]
        turning, coordinates = [3, 4, 5, 6], [7 * (1 + k // 3) + k % 3 for k in range(n)]
        rows = [0, 1, 2, *angular, *velocities]
        inertia = [(i, c) for c in angular for i in range(3)] + [(c, i) for c in angular for i in range(3)]
        inertia += [(i, j) for i in angular for j in angular]
        of_frame = [0, 1, 2, *angular]
        inertia += [(i, k) for i in of_frame for k in velocities] + [(k, i) for i in of_frame for k in velocities]
        inertia += [(k, l) for k in velocities for l in velocities]
        by_pose = [(row, column) for row in rows for column in (*turning, *coordinates)]
        patterns = {
            "f": [(row, 0) for row in rows], "inertia": inertia, "f_q": by_pose, "inertia_q": by_pose,
            "f_u": [(row, column) for row in rows for column in (*angular, *velocities)],
            "kinetic": [(0, 0)], "potential": [(0, 0)], "power": [(0, 0)],
        }  # fmt: skip
        form = _Form(n, n_bodies, patterns)
        return CompiledTerms(patterns, form.source)


@dataclass(frozen=True)
class _Form:
    """Form of bodies with common kernels: numbers of modal coordinates and of bodies, and patterns of the terms."""

    n: int
    n_bodies: int
    patterns: Mapping[str, Any]

    def source(self, places: Mapping[str, int]) -> str:
        """Return the source of a kernel with some of the terms, by their places."""
        width = 2 * self.n_bodies + 1
        pointers = (
            f"{name} = shifted(value, place[{1 + k}] + {len(self.patterns[name])}*e)" for name, k in places.items()
        )
        calls = (CALLS[name].format(n=self.n) for name in CALLS if name in places)
        return "\n".join([
            f"from {MACHINE}.native.access import room, shifted",
            *(f"from {MACHINE}.flexible.{module} import {', '.join(names)}" for module, names in KERNELS.items()),
            "", "",
            "def kernel(count, index, number, t, q, turn, u, a, lam, mu, place, value):",
            f"    work = room({work_size(self.n)})",
            "    for e in range(count):",
            f"        row = shifted(index, {width}*e)",
            f"        numbers = shifted(number, row[{width - 1}])",
            "        own = shifted(numbers, int(numbers[0]))",
            "        turned = shifted(turn, 2*row[0])  # rotation matrix turn[0:9] and quaternion turn[9:13] of the frame",
            *(f"        {pointer}" for pointer in pointers),
            f"        take_sums({self.n}, own, row, q, u, work)",
            *(f"        {call}" for call in calls),
            "",
        ])  # fmt: skip


def flexible_inertias(
    bodies: Mapping[str, object], gravity: tuple[float, ...]
) -> Iterator[tuple[str, FlexibleInertia]]:
    """Yield the inertia and elasticity of the flexible bodies by the names of their frames."""
    for name, body in bodies.items():
        if isinstance(body, FloatingFrame):
            numbers = body.numbers.array.copy()
            numbers[: BODY["gravity"]] = gravity
            i, *modes = (MarkerReference.model_construct(body=each) for each in (name, *body.modes))
            yield name, FlexibleInertia.model_construct(numbers=numbers, i=i, modes=tuple(modes))
