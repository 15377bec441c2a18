"""Function expressions as formulas that name no variables: what is to be integrated has all of them in it."""

from __future__ import annotations

import ast

from .function import Function
from .translate import Translation

MOST_PARTS = 10_000
"""Numbers, names and operations in the value of a VARIABLE, with the others that it uses in it."""


class InPlace(Translation):
    """Translates the expressions of one dataset, each VARIABLE by its own expression."""

    def variable(self, ident: int, function: Function) -> ast.expr:
        """The expression of a VARIABLE in place of its name."""
        variable = self.mechanism.dataset.variables.get(ident)
        if variable is None or ident in self.implicit_variables:
            return super().variable(ident, function)
        value = self.translated(variable.function)
        if sum(1 for _ in ast.walk(value)) > MOST_PARTS:
            raise function.fault(
                f"found VARVAL({ident}), which has more than {MOST_PARTS} parts with the variables in it, expected fewer"
            )
        return value
