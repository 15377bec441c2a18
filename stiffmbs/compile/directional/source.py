"""Source of kernels for directional derivatives of other kernels."""

from __future__ import annotations

import ast
from collections.abc import Collection

from ..terms import KERNEL_ARGUMENTS, KERNEL_SIGNATURE

STATE = ("t", "q", "turn", "u", "a", "lam", "mu")
NUMBER, TIME = "number", "t"
_CHANGES = (NUMBER, *STATE, "value")
SIGNATURE = KERNEL_SIGNATURE.removesuffix(")") + ", float64*, float64, " + ", ".join(["float64*"] * 7) + ")"
"""Signature of a kernel with the derivatives of its inputs, and the place of those of its values, appended."""


def directional_source(source: str, along: Collection[str]) -> str:
    """Return the source of the directional derivative of a kernel; empty if it has none.

    `source`: source of the kernel. `along`: quantities that change: ``number``, and names of `STATE`.
    """
    module = ast.parse(source)
    read = {node.id for node in ast.walk(module) if isinstance(node, ast.Name)}
    moving = [name for name in _CHANGES if name in along and name in read]
    if not moving:
        return ""
    given = ", ".join(
        f"with_derivative({name}, {name}_d)" if name in (*moving, "value") else name
        for name in KERNEL_ARGUMENTS.split(", ")
    )
    return "\n".join([
        "from stiffmbs.compile.machine.native.access import with_derivative",
        source.replace("def kernel(", "def terms("),
        "",
        f"def kernel({KERNEL_ARGUMENTS}, {', '.join(f'{name}_d' for name in _CHANGES)}):",
        f"    terms({given})",
        "",
    ])  # fmt: skip
