"""The law of springs with dampers, shared by the line spring and the torsion spring."""

from __future__ import annotations

from typing import Any

from ..element import Force, Symbolic


class Spring(Force):
    """Base of springs with dampers (it has no kind: scenes name its subclasses).

    At a deflection s and its rate v the spring pulls back with k s + spring_law(s) + c v + damper_law(v) + preload.
    A subclass has these numbers and laws as its fields, in the units of its deflection.
    """

    @staticmethod
    def pull(e: Symbolic, s: Any, v: Any) -> Any:
        """Tension or moment, against the deflection."""
        linear = e.stiffness * s + e.damping * v + e.preload
        laws = [law(x) for law, x in ((e.spring_law, s), (e.damper_law, v)) if law is not None]
        return sum(laws, linear)

    @staticmethod
    def stored(e: Symbolic, s: Any, way: Any) -> Any:
        """Potential energy, J, the preload's counted from `way` zero; zero where the spring law has no simple integral."""
        of_law = e.integral(e.spring_law, s) if e.spring_law is not None else 0
        return e.stiffness * s**2 / 2 + e.preload * way + of_law if of_law is not None else 0
