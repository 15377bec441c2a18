"""Function expressions with variables substituted, for symbolic integration."""

from __future__ import annotations

import ast

from .function import Function
from .translate import Translation

MOST_PARTS = 10_000
"""Largest number of syntax-tree nodes in the value of a VARIABLE after substitution."""


class InPlace(Translation):
    """Translator of one dataset's expressions that substitutes each VARIABLE by its expression."""

    def variable(self, ident: int, function: Function) -> ast.expr:
        """Return the expression of a VARIABLE; its name if it depends on itself."""
        variable = self.mechanism.dataset.variables.get(ident)
        if variable is None or ident in self.implicit_variables:
            return super().variable(ident, function)
        value = self.translated(variable.function)
        if sum(1 for _ in ast.walk(value)) > MOST_PARTS:
            raise function.fault(
                f"found VARVAL({ident}), which has more than {MOST_PARTS} parts with the variables in it, expected fewer"
            )
        return value
