"""Inertia and elasticity of a flexible body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from ....reading.marker import MarkerReference
from ...element import CompiledTerms, Force
from .bodies import FloatingFrame
from .layout import BODY, work_size

NATIVE = "stiffmbs.compile.machine.native"

KERNELS = {
    "inertia": ("add_forces", "add_inertia", "kinetic_energy", "potential_energy", "dissipated_power"),
    "slopes": ("add_force_slopes", "add_inertia_slopes"),
}
"""Compiled functions by their modules."""


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
        for k in velocities:
            for of_frame in ([0, 1, 2], angular):
                inertia += [*((i, k) for i in of_frame), *((k, i) for i in of_frame)]
        inertia += [(k, l) for k in velocities for l in velocities]
        by_pose = [(row, column) for row in rows for column in (*turning, *coordinates)]
        patterns = {
            "f": [(row, 0) for row in rows], "inertia": inertia, "f_q": by_pose, "inertia_q": by_pose,
            "f_u": [(row, column) for row in rows for column in (*angular, *velocities)],
            "kinetic": [(0, 0)], "potential": [(0, 0)], "power": [(0, 0)],
        }  # fmt: skip
        return CompiledTerms(patterns, lambda places: _source(n, n_bodies, patterns, places))


def _source(n: int, n_bodies: int, patterns: Mapping[str, Any], places: Mapping[str, int]) -> str:
    """Return the source of a kernel with some of the terms, by their places."""
    width = 2 * n_bodies + 1
    to = {name: f"shifted(value, place[{1 + k}] + {len(patterns[name])}*e)" for name, k in places.items()}
    pose = f"{n}, own, row, q, turned"
    calls = {
        "f": f"add_forces({pose}, u, work, {to.get('f')})",
        "inertia": f"add_inertia({pose}, u, {to.get('inertia')})",
        "f_q": f"add_force_slopes({pose}, u, work, {to.get('f_q')}, {to.get('f_u')})",
        "inertia_q": f"add_inertia_slopes({pose}, a, {to.get('inertia_q')})",
        "kinetic": f"value[place[{1 + places.get('kinetic', 0)}] + e] = kinetic_energy({pose}, u)",
        "potential": f"value[place[{1 + places.get('potential', 0)}] + e] = potential_energy({pose}, work)",
        "power": f"value[place[{1 + places.get('power', 0)}] + e] = dissipated_power({n}, own, row, q, u, work)",
    }
    return "\n".join(
        [
            f"from {NATIVE}.access import room, shifted",
            *(f"from {NATIVE}.flexible.{module} import {', '.join(names)}" for module, names in KERNELS.items()),
            "",
            "",
            "def kernel(count, index, number, t, q, turn, u, a, lam, mu, place, value):",
            f"    work = room({work_size(n)})",
            "    for e in range(count):",
            f"        row = shifted(index, {width}*e)",
            f"        numbers = shifted(number, row[{width - 1}])",
            "        own = shifted(numbers, int(numbers[0]))",
            "        turned = shifted(turn, 2*row[0])  # rotation matrix turn[0:9] and quaternion turn[9:13] of the frame",
            *(f"        {call}" for name, call in calls.items() if name in places),
            "",
        ]
    )


def flexible_inertias(bodies: Mapping[str, Any], gravity: tuple[float, ...]) -> Iterator[tuple[str, FlexibleInertia]]:
    """Yield the inertia and elasticity of the flexible bodies by the names of their frames."""
    for name, body in bodies.items():
        if isinstance(body, FloatingFrame):
            numbers = body.numbers.array.copy()
            numbers[: BODY["gravity"]] = gravity
            i, *modes = (MarkerReference.model_construct(body=each) for each in (name, *body.modes))
            yield name, FlexibleInertia.model_construct(numbers=numbers, i=i, modes=tuple(modes))
