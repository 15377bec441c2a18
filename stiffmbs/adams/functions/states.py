"""States of a dataset as states of a scene, and their names in formulas."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from ...elements.spatial.number_format import plain, vector
from ..statements.outputs import Variable
from ..statements.systems import Differential, LinearSystem, TransferFunction
from .expression import parse
from .function import Function
from .trees import name_of, times

if TYPE_CHECKING:
    from ..statements.dataset import Dataset
    from ..statements.declared import Numbered
    from .translate import Translation


def states(translation: Translation) -> dict[str, object]:
    """Return the states of the scene by name.

    Raises DatasetFault if a system refers to a missing statement, or its matrices have inconsistent sizes.
    """
    found: dict[str, object] = {}
    for statements in translation.mechanism.dataset.statements.values():
        for ident, one in statements.items():
            match one:
                case Variable() if ident in translation.implicit_variables:
                    value = translation.translated(one.function)
                    zero = ast.BinOp(value, ast.Sub(), name_of(one.state))
                    found[one.state] = {"zero": ast.unparse(zero), "start": plain(one.start)}
                case Differential():
                    found |= _differential(one, translation)
                case LinearSystem():
                    found[one.name] = _linear(one, translation)
                case TransferFunction():
                    found[one.name] = _transfer(one, translation)
    return found


def _differential(one: Differential, translation: Translation) -> dict[str, object]:
    """Return a differential state; the rate of an implicit equation becomes an algebraic state.

    An implicit equation without its rate becomes an algebraic state itself.
    """
    per_second = 1 / translation.units.time
    if not one.implicit:
        return {one.name: {"rate": translation.formula(one.function, per_second), "start": plain(one.starts[0])}}
    rate = one.rate
    used = {node.id for node in ast.walk(translation.translated(one.function)) if isinstance(node, ast.Name)}
    if rate not in used:
        return {one.name: {"zero": translation.formula(one.function), "start": plain(one.starts[0])}}
    return {
        one.name: {"rate": ast.unparse(times(name_of(rate), per_second)), "start": plain(one.starts[0])},
        rate: {"zero": translation.formula(one.function), "start": plain(one.starts[1])},
    }


def depending_on_themselves(dataset: Dataset) -> frozenset[int]:
    """Return the variables whose expressions depend on themselves, directly, through others, or through rates of DIFFs."""
    variables, differentials = (
        {key: _uses(one.function) for key, one in statements.items() if isinstance(one.function, Function)}
        for statements in (dataset.variables, _explicit(dataset))
    )
    uses = {("VARVAL", ident): found for ident, found in variables.items()}
    uses |= {("DIF1", ident): found for ident, found in differentials.items()}
    reached = {key: set(own) for key, own in uses.items()}
    for _ in uses:
        reached = {key: own.union(*(uses.get(other, ()) for other in own)) for key, own in reached.items()}
    return frozenset(ident for ident in variables if ("VARVAL", ident) in reached["VARVAL", ident])


def _explicit(dataset: Dataset) -> dict[int, Differential]:
    return {ident: one for ident, one in dataset.differentials.items() if not one.implicit}


def _uses(function: Function) -> set[tuple[str, int]]:
    """Return the variables and rates in an expression, each by the name of its function and its number."""
    calls = (node for node in ast.walk(function.tree) if isinstance(node, ast.Call) and node.args)
    return {
        (node.func.id, node.args[0].value)
        for node in calls
        if isinstance(node.func, ast.Name) and node.func.id in ("VARVAL", "DIF1")
        and isinstance(node.args[0], ast.Constant) and isinstance(node.args[0].value, int)
    }  # fmt: skip


def differential(dataset: Dataset, ident: int, function: Function) -> Differential:
    """Return the equation that DIF and DIF1 refer to."""
    found = dataset.differentials.get(ident)
    if found is None:
        raise function.fault(f"found DIF({ident}), expected the number of a DIFF")
    return found


def value_of_system(dataset: Dataset, array: int, at: int, function: Function) -> ast.expr | None:
    """Return the scene name of ARYVAL in an array of states or outputs; None if no system uses the array."""
    for statements in dataset.statements.values():
        for one in statements.values():
            match one:
                case TransferFunction(y=output) if output == array and at == 1:
                    return name_of(one.name)
                case TransferFunction(x=state) if state == array:
                    raise function.fault(
                        f"found ARYVAL({array}, {at}), a state of {one.label}, expected its output: Adams does not document "
                        "its choice of states"
                    )
                case LinearSystem(y=output) if output == array:
                    return name_of(f"{one.name}.y{at}")
                case LinearSystem(x=state) if state == array:
                    return name_of(f"{one.name}.s{at}")
    return None


def _inputs(user: Numbered, ident: int | None, translation: Translation) -> list[str]:
    if ident is None:
        return []
    array = translation.mechanism.dataset.arrays.get(ident)
    if array is None or not array.variables:
        raise user.fault(f"found U = {ident}, expected the number of an ARRAY of VARIABLES")
    laws = ((f"VARVAL({k})", parse(f"VARVAL({k})")) for k in array.variables)
    return [translation.formula(Function(*law, user.line, user.label)) for law in laws]


def _transfer(one: TransferFunction, translation: Translation) -> dict[str, object]:
    """Return a transfer function with SI coefficients, highest power first."""
    unit, inputs = translation.units.time, _inputs(one, one.u, translation)
    if len(inputs) != 1:
        raise one.fault(f"found {len(inputs)} VARIABLES of U = {one.u}, expected one")
    top, bottom = (vector([c * unit**k for k, c in enumerate(part)][::-1]) for part in (one.numerator, one.denominator))
    return {"numerator": top, "denominator": bottom, "input": inputs[0]}


def _linear(one: LinearSystem, translation: Translation) -> dict[str, object]:
    """Return a linear system in SI units; its outputs are those of the dataset and its states."""
    unit, inputs = translation.units.time, _inputs(one, one.u, translation)
    a = _rows(one, "A", one.a, translation)
    n, m = len(a), len(inputs)
    b = _rows(one, "B", one.b, translation) if inputs else ((0.0,),) * n
    c = _rows(one, "C", one.c, translation) if one.c else ()
    d = _rows(one, "D", one.d, translation) if one.d else ((0.0,) * max(m, 1),) * len(c)
    expected = {"A": (a, n, n), "B": (b, n, max(m, 1)), "C": (c, len(c), n), "D": (d, len(c), max(m, 1))}
    for name, (rows, high, wide) in expected.items():
        if len(rows) != high or any(len(row) != wide for row in rows):
            raise one.fault(
                f"found {name} of {len(rows)} by {len(rows[0])} numbers, expected {high} rows and {wide} columns"
            )
    identity = [[1 if i == k else 0 for i in range(n)] for k in range(n)]
    made: dict[str, object] = {
        "a": [vector([x / unit for x in row]) for row in a],
        "b": [vector([x / unit for x in row]) for row in b],
        "c": [*(vector(row) for row in c), *identity],
        "d": [*(vector(row) for row in d), *([0] * max(m, 1) for _ in range(n))],
        "input": inputs or [0],
        "outputs": [*(f"y{k + 1}" for k in range(len(c))), *(f"s{k + 1}" for k in range(n))],
    }
    if one.start is not None:
        array = translation.mechanism.dataset.arrays.get(one.start)
        if array is None or len(array.numbers) != n:
            raise one.fault(f"found IC = {one.start}, expected the number of an ARRAY of {n} numbers")
        made["start"] = vector(array.numbers)
    return made


def _rows(one: LinearSystem, name: str, ident: int | None, translation: Translation) -> tuple[tuple[float, ...], ...]:
    matrix = translation.mechanism.dataset.matrices.get(ident or 0)
    if matrix is None:
        raise one.fault(f"found {name} = {ident}, expected the number of a MATRIX")
    return matrix.rows
