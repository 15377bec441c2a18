"""Force law of springs with dampers, for line springs and torsion springs."""

from __future__ import annotations

from typing import Any

from ..element import Force, Symbolic


class Spring(Force):
    """Base of springs with dampers; scenes use its subclasses.

    At a deflection s and its rate v the restoring force is k s + spring_law(s) + c v + damper_law(v) + preload. A
    subclass has these numbers and laws as its fields, in the units of its deflection.
    """

    @staticmethod
    def pull(e: Symbolic, s: Any, v: Any) -> Any:
        """Return the restoring force or moment."""
        linear = e.stiffness * s + e.damping * v + e.preload
        laws = [law(x) for law, x in ((e.spring_law, s), (e.damper_law, v)) if law is not None]
        return sum(laws, linear)

    @staticmethod
    def stored(e: Symbolic, s: Any, way: Any) -> Any:
        """Return the potential energy, J, zero without a closed form; the preload's is zero at `way` = 0."""
        of_law = e.integral(e.spring_law, s) if e.spring_law is not None else 0
        return e.stiffness * s**2 / 2 + e.preload * way + of_law if of_law is not None else 0
