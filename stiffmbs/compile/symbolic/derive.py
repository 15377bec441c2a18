"""Derivation of all terms of an element from its equations with SymPy.

For C(q, t): V = C', J = dV/du, gamma = -V' at constant u so that J u' = gamma, and d(J^T w)/dq for given multipliers w.
For efforts Q_k on rates v_k: f = sum (dv_k/du)^T Q_k, f_q and f_u. For spatial bodies: p' = Z w. The reaction is the
generalised force on the first body as force and torque about the element's point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from random import Random

import sympy as sp

from ...elements.element import Force, Joint
from ...elements.states.equation import AngleCounter, Reported, SampledUpdate, StateEquation
from ...errors import InputError
from ..kind import Kind
from .continuous_angle import away_from_pole
from .element import SymbolicElement
from .element_equations import ElementEquations, equations_of_force, equations_of_joint, measured_of_joint, multipliers
from .residue import PRIME, residue
from .symbols import Symbols, symbols_of
from .variation import Summand, Variation


@dataclass(frozen=True)
class Entry:
    """Structurally non-zero entry of a term: its expression and its position in the element's own block.

    `row` and `column` index the element's equations, velocities or coordinates.
    """

    expression: sp.Expr
    row: int
    column: int = 0


@dataclass(frozen=True)
class LateEntry:
    """Entry whose expression is derived on first use, for rarely used terms. It may be zero."""

    derived: Callable[[], sp.Expr]
    row: int
    column: int

    @property
    def expression(self) -> sp.Expr:
        """Expression of the entry."""
        return self.derived()


@dataclass(frozen=True)
class Derived:
    """Terms of a kind; for all other fields see `stiffmbs.compile.record.KindRecord`.

    `symbols`: symbols of the expressions. `terms`: non-zero entries of each term in row order, by the names of
    `stiffmbs.compile.terms.TERM_AXES`.
    """

    n_equations: int
    n_holonomic: int
    symbols: Symbols
    terms: dict[str, Sequence[Entry | LateEntry]]
    losses: list[int] | None
    variation: list[list[Summand]] = field(default_factory=list)
    removable: list[bool] = field(default_factory=list)
    timed: list[bool] = field(default_factory=list)


def derive(kind: Kind) -> Derived:
    """Derive all terms of a kind from its equations.

    Raises InputError if an equation depends on no coordinate of a body, is nonlinear in velocities, or contains a
    reaction.
    """
    symbols = symbols_of(kind)
    if issubclass(kind.element, Joint):
        derived = _derived_joint(kind, symbols)
    elif issubclass(kind.element, AngleCounter):
        derived = Derived(0, 0, symbols, {}, [])
    elif issubclass(kind.element, StateEquation | Reported):
        derived = _derived_state(kind, symbols)
    else:
        assert issubclass(kind.element, Force)
        derived = _derived_force(kind, symbols)
    return replace(derived, terms=derived.terms | _counting(symbols.element)) if symbols.element.angles else derived


def _derived_joint(kind: Kind, symbols: Symbols) -> Derived:
    e, equations = symbols.element, equations_of_joint(kind, symbols)
    C, rates = sp.Matrix(equations.position), sp.Matrix(equations.velocity)
    V = sp.Matrix([*(e.rate(equation) for equation in C), *rates])
    J = e.by_u.matrix(V)
    _refuse_rates_by_velocities(e, C)
    for row in range(J.rows):
        if all(entry == 0 for entry in J[row, :]):
            raise InputError(
                f"{kind.element.__name__}: found equation {row + 1} of {J.rows}, which depends on no coordinate of a body"
            )
        if any(e.depends(entry, e.velocities) for entry in J[row, :]):
            raise InputError(
                f"{kind.element.__name__}: found equation {row + 1} of {J.rows} with products or powers of velocities, expected one that is linear "
                "in velocities"
            )
    if any(e.depends(entry, symbols.pressed) for entry in V):
        raise InputError(
            f"{kind.element.__name__}: found a reaction in its equations, expected formulas without reactions"
        )
    lam, mu = multipliers("lam", V.rows), multipliers("mu", V.rows)
    force = e.by_u.work(zip(lam, V, strict=True))
    turning = e.rate(V)
    in_space = kind.dimensions == 3  # in the plane `turning` has fewer products
    second = [*(map(e.second_rate, C) if in_space else turning[: len(C), :]), *turning[len(C) :, :]]
    power = power_of_joint(e, V, lam)
    terms = {
        "C": sp.Matrix([*C, *sp.zeros(len(rates), 1)]), "C_q": e.by_q.matrix(C), "V": V, "J": J, "V_q": e.by_q.matrix(V),
        "gamma": -sp.Matrix(second),
        "G_lam": e.by_q.matrix(force), "G_mu": _symmetric(e.by_q.matrix(e.by_q.work(zip(mu, C, strict=False)))),
        "gamma_u": -e.by_u.matrix(turning),
        "reaction": _reaction(equations, e, -force),
        "event_function": sp.Matrix(equations.event_functions), "power": sp.Matrix([power]),
        "argument": symbols.arguments,
    }  # fmt: skip
    entries: dict[str, Sequence[Entry | LateEntry]] = {name: _entries(matrix) for name, matrix in terms.items()}
    first_state = len(e.by_q.slopes) - len(e.states)  # states are given: reactions and projections do not act on them
    entries["C_x"] = [entry for entry in entries["C_q"] if entry.column >= first_state]
    entries["C_q"] = [entry for entry in entries["C_q"] if entry.column < first_state]
    entries["G_mu"] = [entry for entry in entries["G_mu"] if entry.row < first_state]
    entries["A_q"] = [
        LateEntry(partial(e.by_q.derivative, row, column), r, column)
        for r, row in enumerate(e.by_accelerations(equation) + rest for equation, rest in zip(V, second, strict=True))
        for column in e.by_q.of(row)
    ]
    entries["measured"] = _entries(sp.Matrix(measured_of_joint(kind, symbols, lam)))
    for name in ("C", "V"):  # complete, including zeros: solvers find them by row
        entries[name] = [Entry(terms[name][row], row) for row in range(V.rows)]
    variation = Variation(symbols)
    return Derived(
        V.rows, C.rows, symbols, entries, [] if power == 0 else None,
        [variation.summands(entry.expression) for entry in entries["C_q"]],
        [variation.removable(C[r], [entry.column for entry in entries["C_q"] if entry.row == r]) for r in range(C.rows)],
        [e.depends(equation, [e.t, *e.states]) for equation in (*C, *rates)],
    )  # fmt: skip


def _refuse_rates_by_velocities(e: SymbolicElement, C: sp.Matrix) -> None:
    """Refuse position constraints with states whose rates depend on velocities: J would differ from dC/dq."""
    for state, rate in zip(e.states, e.state_rates, strict=False):
        if any(e.depends(equation, [state]) for equation in C) and e.depends(rate, e.velocities):
            raise InputError(
                "found a state whose rate follows velocities in a constraint of positions, expected one whose rate follows "
                "positions, time and other states"
            )


def _derived_force(kind: Kind, symbols: Symbols) -> Derived:
    e, equations = symbols.element, equations_of_force(kind, symbols)
    f = e.by_u.work(equations.powers)
    joint_lam = symbols.pressed
    power, losses = power_of_force(equations, symbols, kind.element.may_keep_energy)  # type: ignore[attr-defined]
    terms = {
        "f": f, "f_q": e.by_q.matrix(f), "f_u": e.by_u.matrix(f),
        "f_lam": e.by(f, joint_lam) if joint_lam else sp.zeros(0, 0),
        "reaction": _reaction(equations, e, f), "potential": sp.Matrix([equations.potential]),
        "event_function": sp.Matrix(equations.event_functions), "limit": sp.Matrix(equations.limits),
        "argument": symbols.arguments, "power": sp.Matrix([power]), "measured": sp.Matrix(equations.measured),
    }  # fmt: skip
    if kind.element.turns:  # type: ignore[attr-defined]
        terms |= _turning(e)
    entries: dict[str, Sequence[Entry | LateEntry]] = {name: _entries(matrix) for name, matrix in terms.items()}
    entries |= _rates(e, sp.Matrix(equations.rates), e.own, joint_lam)
    entries |= _condensed(e, equations)
    for name, of in (("f_alg", "f_q"), ("rate_alg", "rate_q")):
        entries[name] = _of_algebraic(kind, e, entries[of])
    return Derived(0, 0, symbols, entries, losses)


def _condensed(e: SymbolicElement, equations: ElementEquations) -> dict[str, Sequence[Entry | LateEntry]]:
    """Return the efforts of a stiff force, the derivatives of its rates by velocities, and those of the efforts."""
    efforts = [effort for effort, _ in equations.condensed]
    return {
        "effort": [Entry(effort, row) for row, effort in enumerate(efforts)],
        "lever": _entries(e.by_u.matrix(rate for _, rate in equations.condensed)),
        "effort_q": [
            LateEntry(partial(e.by_q.derivative, effort, column), row, column)
            for row, effort in enumerate(efforts)
            for column in e.by_q.of(effort)
        ],
        "effort_u": [
            LateEntry(partial(e.by_u.derivative, effort, column), row, column)
            for row, effort in enumerate(efforts)
            for column in e.by_u.of(effort)
        ],
    }


def _rates(
    e: SymbolicElement, rates: sp.Matrix, states: Sequence[sp.Symbol], joint_lam: Sequence[sp.Symbol]
) -> dict[str, Sequence[Entry | LateEntry]]:
    """Return the rates of states and their derivatives, in the rows of the states."""
    rows = [len(e.by_q.slopes) - len(e.states) + e.states.index(state) for state in states]
    terms = {"rate": rates, "rate_q": e.by_q.matrix(rates), "rate_u": e.by_u.matrix(rates)}
    terms["rate_lam"] = e.by(rates, joint_lam) if joint_lam else sp.zeros(0, 0)
    return {name: [replace(entry, row=rows[entry.row]) for entry in _entries(matrix)] for name, matrix in terms.items()}


def _derived_state(kind: Kind, symbols: Symbols) -> Derived:
    """Return the rate of a state, in the row of that state, and its reported value."""
    e, element = symbols.element, kind.element
    if issubclass(element, SampledUpdate):
        symbols.laws.clear()  # no step looks at them
        return Derived(0, 0, symbols, {"signal": [Entry(sp.sympify(e.formula), 0)]}, [])
    formula = sp.sympify(element.rate(e) if issubclass(element, StateEquation) else e.formula)
    value = sp.Matrix([formula])
    joint_lam = symbols.pressed
    terms = {"signal": value, "event_function": sp.Matrix(symbols.event_functions), "argument": symbols.arguments}
    entries: dict[str, Sequence[Entry | LateEntry]] = {name: _entries(matrix) for name, matrix in terms.items()}
    entries["signal"] = [Entry(formula, 0)]
    if issubclass(element, StateEquation):
        entries |= _rates(e, value, [e.state], joint_lam)
        entries["rate_alg"] = _of_algebraic(kind, e, entries["rate_q"])
    return Derived(0, 0, symbols, entries, [])


def _of_algebraic(kind: Kind, e: SymbolicElement, entries: Sequence[Entry | LateEntry]) -> list[Entry | LateEntry]:
    """Return the entries of a matrix in the columns of algebraic states."""
    first = len(e.by_q.slopes) - len(e.states)
    return [entry for entry in entries if entry.column - first in kind.algebraic]


def _turning(e: SymbolicElement) -> dict[str, sp.Matrix]:
    """Return Z of p' = Z w in the rows and columns of a body's coordinates and velocities, and d(Z w)/dq."""
    (body,) = e.frames
    Z, rates = sp.zeros(len(body.q), len(body.u)), sp.zeros(len(body.q), 1)
    Z[3:, 3:] = body.quaternion_rates(sp.Matrix(body.q[3:])) * sp.Matrix(body.followed).jacobian(body.u[3:])
    rates[3:, :] = Z[3:, 3:] * sp.Matrix(body.u[3:])
    return {"Z": Z, "Z_q": e.by_q.matrix(rates)}


def _counting(e: SymbolicElement) -> dict[str, list[Entry]]:
    """Return the counted angles and their rates, in rows after the bodies' coordinates."""
    first = len(e.by_q.slopes)
    rates, bounded = sp.Matrix([e.rate(angle) for angle in e.angles]), [away_from_pole(angle, e) for angle in e.angles]
    of_rates = {"angle_rate": rates, "Z": e.by_u.matrix(rates), "Z_q": e.by_q.matrix(rates)}
    entries = {
        name: [replace(entry, expression=bounded[entry.row](entry.expression)) for entry in _entries(matrix)]
        for name, matrix in of_rates.items()
    }
    entries["continuous_angle"] = _entries(sp.Matrix(e.angles))
    return {name: [replace(entry, row=first + entry.row) for entry in found] for name, found in entries.items()}


def _reaction(equations: ElementEquations, e: SymbolicElement, force: sp.Matrix) -> sp.Matrix:
    """Return force and torque about the element's point from the generalised force on its first body."""
    first = e.frames[0]
    return first.wrench(force[: len(first.u), :], sp.Matrix(equations.point))


def _symmetric(second: sp.Matrix) -> sp.Matrix:
    """Return second derivatives in symmetric form, so that off-diagonal entries are computed once."""
    return sp.Matrix(*second.shape, lambda r, c: second[min(r, c), max(r, c)])


def _entries(matrix: sp.Matrix) -> list[Entry]:
    columns = matrix.cols
    return [Entry(x, *divmod(k, columns)) for k, x in enumerate(map(sp.sympify, matrix.flat())) if x != 0]


NO_VALUE = (sp.nan, sp.zoo, sp.oo, -sp.oo)


def without(e: SymbolicElement, x: sp.Basic, symbols: frozenset[sp.Symbol]) -> sp.Basic:
    """Return an expression with some symbols set to zero, also in named subexpressions."""
    if isinstance(x, sp.Symbol):
        if x in symbols:
            return sp.Integer(0)
        meaning = e.meanings.get(x)
        return x if meaning is None or not e.depends(x, symbols) else without(e, meaning, symbols)
    return x.func(*(without(e, part, symbols) for part in x.args)) if x.args else x


def power_of_joint(e: SymbolicElement, V: sp.Matrix, lam: sp.Matrix) -> sp.Expr:
    """Return lam^T C_t, with C_t from the velocity level V = J u + C_t at rest."""
    at_rest = frozenset(e.velocities)
    return sp.Add(*(factor * without(e, row, at_rest) for factor, row in zip(lam, V, strict=True)))


def power_of_force(
    equations: ElementEquations, symbols: Symbols, may_keep: bool = True
) -> tuple[sp.Expr, list[int] | None]:
    """Return a force's power beyond the rate of its potential, and the numbers that must be zero for it to vanish.

    `may_keep`: `Force.may_keep_energy`. Returns `power`: W; `losses`: numbers of the element, in the order of
    `ElementData.numbers`; None if unknown.
    """
    e, powers, potential = symbols.element, equations.powers, equations.potential
    work = sp.Add(*(Q * v for Q, v in powers))
    if not may_keep:
        return work if potential == 0 else work + e.rate(potential), None
    if potential == 0:
        return (sp.Integer(0), []) if _vanishes(work) else (work, None)
    losses = _losses(symbols, [Q for Q, _ in powers])
    return (sp.Integer(0) if losses == [] else work + e.rate(potential)), losses


def _vanishes(work: sp.Expr) -> bool:
    """Return True if a rational function is zero, as its products cancel: the power of a gyroscopic torque.

    It is evaluated at large numbers without a pattern, as small ones may be zeros of factors such as a - 3.
    """
    names, numbers = sorted(work.free_symbols, key=str), Random(1)
    return residue(work, {name: numbers.randrange(PRIME) for name in names}) == 0


def _losses(symbols: Symbols, efforts: list[sp.Expr]) -> list[int] | None:
    """Return the numbers that vanish from efforts at rest, if efforts without them depend on the pose only.

    A force with a potential states the potential of its efforts at rest.
    """
    e = symbols.element
    velocities = frozenset(e.velocities)
    at_rest = [without(e, Q, velocities) for Q in efforts]
    lost = _numbers_in(symbols, efforts) - _numbers_in(symbols, at_rest)
    kept = [without(e, Q, lost) for Q in efforts]
    changing = [e.t, *velocities, *e.states, *symbols.pressed]
    if any(Q.has(*NO_VALUE) or e.depends(Q, changing) for Q in kept):
        return None
    return [k for k, number in enumerate(symbols.numbers) if number in lost]


def _numbers_in(symbols: Symbols, expressions: Iterable[sp.Basic]) -> frozenset[sp.Symbol]:
    found: frozenset[sp.Symbol] = frozenset()
    for expression in expressions:
        found |= symbols.element.derivatives.variables(expression)
    return found & frozenset(symbols.numbers)
