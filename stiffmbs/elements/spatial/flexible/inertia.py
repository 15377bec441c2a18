"""Inertia and elasticity of a flexible body."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from ....reading.marker import MarkerReference
from ...element import CompiledTerms, Force
from .bodies import FloatingFrame
from .layout import BODY, width, work_size

NATIVE = "stiffmbs.compile.machine.native"

KERNELS = {
    "inertia": ("add_forces", "add_inertia", "kinetic_energy", "potential_energy", "dissipated_power"),
    "slopes": ("add_force_slopes", "add_inertia_slopes"),
    "sums": ("take_sums",),
    "along": ("add_elastic_change", "energy_change", "power_change", "step_size"),
}
"""Compiled functions by their modules."""
SUMS = "take_sums({n}, {own}, {at}, {u}, work)"
CALLS = {
    "f": "add_forces({n}, {own}, {gravity}, {frame}, {u}, work, {to})",
    "inertia": "add_inertia({n}, {own}, {turned}, work, {to})",
    "kinetic": "{to}[0] = kinetic_energy({n}, {own}, {frame}, {u}, work)",
    "potential": "{to}[0] = potential_energy({n}, {own}, {gravity}, {turned}, work)",
    "power": "{to}[0] = dissipated_power({n}, {own}, work)",
}
"""Computation of the terms without their slopes."""
WORDS = {"own": "own", "gravity": "own", "at": "row, q", "frame": "row, turned", "turned": "turned", "u": "u"}
"""Arguments of these computations at a state."""
CHANGES = {
    "f": "add_elastic_change({changed}, {to})",
    "potential": "{to}[0] += energy_change({changed})",
    "power": "{to}[0] += power_change({changed})",
}
"""Parts of the derivatives by the numbers of the body that are not linear in these."""


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
        return CompiledTerms(patterns, form.source, form.along)


@dataclass(frozen=True)
class _Form:
    """Form of bodies with common kernels: numbers of modal coordinates and of bodies, and patterns of the terms."""

    n: int
    n_bodies: int
    patterns: Mapping[str, Any]

    def source(self, places: Mapping[str, int]) -> str:
        """Return the source of a kernel with some of the terms, by their places."""
        to, n = self._to(places), self.n
        calls = [f"{name} = {to[name]}" for name in places]
        calls += self._calls(places, WORDS, {name: name for name in places})
        if "f_q" in places:
            calls.append(f"add_force_slopes({n}, own, row, turned, u, work, f_q, f_u)")
        if "inertia_q" in places:
            calls.append(f"add_inertia_slopes({n}, own, row, turned, a, work, inertia_q)")
        return self._kernel("", calls)

    def along(self, places: Mapping[str, int]) -> str:
        """Return the source of a kernel of directional derivatives."""
        smooth = {name: k for name, k in places.items() if name in CALLS}
        to, n, bodies = self._to(smooth), self.n, self.n_bodies
        size = max((len(self.patterns[name]) for name in smooth), default=1)
        rooms = {
            "none": 1, "places": 2 * bodies, "q_m": 7 * bodies, "turn_m": 14 * bodies, "u_m": 6 * bodies, "gravity_m": 3,
            "found": size, "changes": 4 * width(n),
        }  # fmt: skip
        of_numbers = WORDS | {"own": "own_d"}
        moved = WORDS | {"gravity": "gravity_m", "at": "places, q_m", "frame": "places, turn_m"}
        moved |= {"turned": "turn_m", "u": "u_m"}
        lines = [
            *(f"{name} = room({count})" for name, count in rooms.items()),
            f"own_d = shifted(number_d, row[{2 * bodies}] + int(numbers[0]))",
            *(f"{name} = {pointer}" for name, pointer in to.items()),
            *self._calls(smooth, of_numbers, {name: name for name in smooth}),
            *(CHANGES[name].format(changed=f"{n}, own, own_d, work, changes", to=name) for name in smooth if name in CHANGES),
            f"h = step_size({n}, own, row, u, own_d, q_d, u_d)",
            "for k in range(4 if h > 0.0 else 0):",
            "    side = -2.0 if k == 0 else (-1.0 if k == 1 else (1.0 if k == 2 else 2.0))",
            "    weight = (1.0 if k == 0 else (-8.0 if k == 1 else (8.0 if k == 2 else -1.0))) / (12.0 * h)",
            f"    move(1, {bodies}, 0, side * h, none, row, q, u, none, q_d, u_d, none, places, q_m, turn_m, u_m)",
            "    for i in range(3):",
            "        gravity_m[i] = own[i] + side * h * own_d[i]",
        ]  # fmt: skip
        for name in smooth:
            lines += [f"    {line}" for line in self._calls([name], moved, {name: "found"})]
            lines.append(f"    add_times({len(self.patterns[name])}, weight, found, {name})")
        imports = "beams.along import move", "vectors import add_times"
        return self._kernel(", number_d, t_d, q_d, turn_d, u_d, a_d, lam_d, mu_d", lines, imports)

    def _to(self, places: Mapping[str, int]) -> dict[str, str]:
        """Return the pointers to the values of the terms."""
        return {name: f"shifted(value, place[{1 + k}] + {len(self.patterns[name])}*e)" for name, k in places.items()}

    def _calls(self, names: Iterable[str], words: Mapping[str, str], to: Mapping[str, str]) -> list[str]:
        """Return the computations of some terms."""
        first = SUMS.format(n=self.n, **words)
        return [first, *(CALLS[name].format(n=self.n, to=to[name], **words) for name in names if name in CALLS)]

    def _kernel(self, arguments: str, body: Iterable[str], imports: Iterable[str] = ()) -> str:
        """Return the text of a kernel with statements for each body."""
        width = 2 * self.n_bodies + 1
        return "\n".join([
            f"from {NATIVE}.access import room, shifted",
            *(f"from {NATIVE}.{each}" for each in imports),
            *(f"from {NATIVE}.flexible.{module} import {', '.join(names)}" for module, names in KERNELS.items()),
            "", "",
            f"def kernel(count, index, number, t, q, turn, u, a, lam, mu, place, value{arguments}):",
            f"    work = room({work_size(self.n)})",
            "    for e in range(count):",
            f"        row = shifted(index, {width}*e)",
            f"        numbers = shifted(number, row[{width - 1}])",
            "        own = shifted(numbers, int(numbers[0]))",
            "        turned = shifted(turn, 2*row[0])  # rotation matrix turn[0:9] and quaternion turn[9:13] of the frame",
            *(f"        {line}" for line in body),
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
