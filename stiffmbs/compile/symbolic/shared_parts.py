"""Common subexpressions of sums and products, as a graph in which each part occurs once.

The graph is much faster than SymPy's `cse`, which rebuilds every expression for every shared part.  Pairs of factors, or of
terms, are shared greedily, the most frequent first (Hosangadi, Fallah, Kastner, IEEE Trans. CAD 25, 2006).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from heapq import heapify, heappop, heappush
from itertools import combinations
from math import inf, isfinite
from typing import Any, Final

import sympy as sp
from sympy.printing.printer import Printer

from .differentiate import Derivatives

Number = int | Fraction | float
Term = tuple[Number, int]
"""Factor, and number of a node; `ONE` for a plain number."""
ONE: Final = 0
SUM, PRODUCT, INVERSE, ROOT, CALL, ATOM = range(6)
"""Kinds of nodes: their parts are terms, nodes, one node, one term, nodes, and one symbol."""
Node = tuple[Any, ...]
"""Kind, then parts; a call has its text as first part."""
MOST_FACTORS = 6
"""Largest power that is written as a product."""


@dataclass(frozen=True)
class Written:
    """Assignments in order of dependence, texts of the results, and the symbols that both use."""

    assignments: list[tuple[str, str]]
    results: list[str]
    symbols: set[sp.Symbol]


def written(
    outputs: Sequence[sp.Expr], derivatives: Derivatives, given: Mapping[sp.Expr, sp.Symbol], printer: Printer
) -> Written:  # fmt: skip
    """Return expressions as source code in which each common part is computed once.

    `derivatives` has the expressions of named symbols. `given`: symbols that replace some expressions. `printer` prints
    functions.
    """
    graph = _Graph(given, printer)
    for symbol in _used(outputs, derivatives):
        graph.known[symbol] = graph.term(derivatives.meanings[symbol])
    results = [graph.term(output) for output in outputs]
    _share_pairs(graph, PRODUCT)
    _share_multiples(graph)
    _share_pairs(graph, SUM)
    return _Writer(graph, results).written()


def _used(outputs: Iterable[sp.Expr], derivatives: Derivatives) -> list[sp.Symbol]:
    """Return the named symbols that outputs need, in order of definition."""
    meanings = derivatives.meanings
    found: set[sp.Symbol] = set()
    following = list(outputs)
    while following:
        new = {symbol for symbol in derivatives.symbols_in(following.pop()) if symbol in meanings} - found
        found |= new
        following += [meanings[symbol] for symbol in new]
    return [symbol for symbol in meanings if symbol in found]


class _Graph:
    """Nodes by number; equal nodes have one number."""

    def __init__(self, given: Mapping[sp.Expr, sp.Symbol], printer: Printer) -> None:
        self.nodes: list[Node] = [(ATOM, None)]
        self.known: dict[sp.Basic, Term] = {}
        self._numbers: dict[Node, int] = {}
        self._given, self._printer = given, printer

    def number(self, node: Node) -> int:
        """Return the number of a node, which is added if it is new."""
        if node not in self._numbers:
            self._numbers[node] = len(self.nodes)
            self.nodes.append(node)
        return self._numbers[node]

    def term(self, x: sp.Expr) -> Term:
        """Return an expression as a number times a node."""
        if x not in self.known:
            self.known[x] = self._term(self._given.get(x, x))
        return self.known[x]

    def _term(self, x: sp.Expr) -> Term:
        match x:
            case sp.Integer():
                return int(x), ONE
            case sp.Rational():
                return Fraction(int(x.p), int(x.q)), ONE
            case sp.Number() | sp.NumberSymbol():
                return float(x), ONE
            case sp.Symbol():
                return 1, self.number((ATOM, x))
            case sp.Add():
                return self.sum(map(self.term, x.args))
            case sp.Mul():
                return self.product(map(self.term, x.args))
            case sp.Pow() if (2 * x.exp).is_Integer and abs(x.exp) <= MOST_FACTORS:
                return self._power(self.term(x.base), 2 * x.exp)
            case _:
                return 1, self._call(x)

    def sum(self, terms: Iterable[Term]) -> Term:
        """Return a sum, with the sign of its first term, and the size of all terms if they have one, as factor."""
        factors: dict[int, Number] = {}
        for factor, node in terms:
            factors[node] = factors.get(node, 0) + factor
        kept = sorted((node, factor) for node, factor in factors.items() if factor)
        if len(kept) < 2:
            return (kept[0][1], kept[0][0]) if kept else (0, ONE)
        sign = -1 if kept[0][1] < 0 else 1
        sizes = {_size(factor) for _, factor in kept}
        if len(sizes) > 1:
            return sign, self.number((SUM, *((sign * factor, node) for node, factor in kept)))
        terms = ((sign if factor > 0 else -sign, node) for node, factor in kept)
        return sign * sizes.pop(), self.number((SUM, *terms))

    def product(self, terms: Iterable[Term]) -> Term:
        """Return a product; factors that are products are not expanded."""
        factor: Number = 1
        nodes = []
        for each, node in terms:
            factor *= each
            nodes += [] if node == ONE else [node]
        if not factor or len(nodes) < 2:
            return factor, nodes[0] if factor and nodes else ONE
        return factor, self.number((PRODUCT, *sorted(nodes)))

    def _power(self, base: Term, twice: int) -> Term:
        whole, half = divmod(abs(int(twice)), 2)
        root: list[Term] = [(1, self.number((ROOT, base)))] if half else []
        factor, node = self.product([base] * whole + root)
        if twice > 0:
            return factor, node
        inverse = (Fraction(1) if isinstance(factor, int) else 1) / factor if factor else inf
        return inverse, self.number((INVERSE, node)) if node != ONE else ONE

    def _call(self, x: sp.Expr) -> int:
        """Return the node of any other function, with symbols for its arguments."""
        parts: list[int] = []
        text = self._printer.doprint(self._of_symbols(x, parts))
        return self.number((CALL, text, *parts))

    def _of_symbols(self, x: sp.Basic, parts: list[int]) -> sp.Basic:
        return x.func(*(self._symbol(part, parts) for part in x.args))

    def _symbol(self, x: sp.Basic, parts: list[int]) -> sp.Basic:
        if not isinstance(x, sp.Expr):
            return self._of_symbols(x, parts) if x.args else x
        if x.is_Number:
            return x
        factor, node = self.term(x)
        if node == ONE:
            return sp.sympify(factor)
        if factor != 1:
            node = self.number((SUM, (factor, node)))
        parts.append(node)
        kind, first, *_ = self.nodes[node]
        return first if kind == ATOM else sp.Symbol(_name(node), real=True)


_NAME = re.compile(r"\bs_(\d+)\b")


def _name(node: int) -> str:
    return f"s_{node}"


def _share_multiples(graph: _Graph) -> None:
    """Make separate nodes of multiples that occur in several sums."""
    sums = {k: node[1:] for k, node in enumerate(graph.nodes) if node[0] == SUM and len(node) > 2}
    counts = Counter((abs(factor), node) for terms in sums.values() for factor, node in terms)
    shared = {
        term: graph.number((SUM, term))
        for term, count in counts.items()
        if count > 1 and term[0] != 1 and term[1] != ONE
    }
    for k, terms in sums.items():
        changed = ((-1 if term[0] < 0 else 1, shared.get((abs(term[0]), term[1]))) for term in terms)
        graph.nodes[k] = (
            SUM,
            *(term if new is None else (sign, new) for term, (sign, new) in zip(terms, changed, strict=True)),
        )


def _share_pairs(graph: _Graph, kind: int) -> None:
    """Replace pairs of factors, or of terms up to their sign, that occur in several nodes by nodes of their own."""
    items = {k: list(node[1:]) for k, node in enumerate(graph.nodes) if node[0] == kind and len(node) > 2}
    places: dict[tuple[object, object], dict[int, None]] = {}
    for k, parts in items.items():
        for pair in _pairs(parts, kind):
            places.setdefault(pair, {})[k] = None
    waiting = [(-len(found), pair) for pair, found in places.items() if len(found) > 1]
    heapify(waiting)
    while waiting:
        count, pair = heappop(waiting)
        within = [k for k in places[pair] if _sign_in(items[k], pair, kind)]
        if len(within) < 2:
            continue
        if len(within) < -count:
            places[pair] = dict.fromkeys(within)
            heappush(waiting, (-len(within), pair))
            continue
        new = graph.number((kind, *pair))
        items.setdefault(new, list(pair))
        for k in within:
            if k == new:
                continue
            sign = _sign_in(items[k], pair, kind)
            for part in pair:
                items[k].remove(_times(sign, part, kind))
            added = _times(sign, (1, new) if kind == SUM else new, kind)
            for other in dict.fromkeys(items[k]):
                changed = next(_pairs([other, added], kind))
                found = places.setdefault(changed, {})
                found[k] = None
                if len(found) > 1:
                    heappush(waiting, (-len(found), changed))
            items[k].append(added)
    for k, parts in items.items():
        graph.nodes[k] = (kind, *parts)


def _pairs(parts: Sequence[Any], kind: int) -> Iterator[tuple[Any, Any]]:
    """Yield the pairs of parts in a fixed order; those of terms with a positive first factor."""
    for pair in combinations(parts, 2):
        first, second = sorted(pair, key=(lambda term: term[1]) if kind == SUM else None)
        sign = -1 if kind == SUM and first[0] < 0 else 1
        yield _times(sign, first, kind), _times(sign, second, kind)


def _times(sign: int, part: Any, kind: int) -> Any:
    return (sign * part[0], part[1]) if kind == SUM else part


def _sign_in(parts: list[object], pair: tuple[object, object], kind: int) -> int:
    """Return the sign with which parts contain a pair, or 0."""
    first, second = pair
    if kind == PRODUCT:
        return int(parts.count(first) > 1 if first == second else first in parts and second in parts)
    for sign in (1, -1):
        if _times(sign, first, kind) in parts and _times(sign, second, kind) in parts:
            return sign
    return 0


class _Writer:
    """Source code of a graph, in which nodes get names that are used more than once."""

    def __init__(self, graph: _Graph, results: Sequence[Term]) -> None:
        self._nodes, self._results = graph.nodes, results
        self._texts: dict[int, str] = {}
        self._inline: dict[int, int] = {}
        self._order = self._postorder()
        self._uses = Counter(node for _, node in results)
        for k in self._order:
            self._uses.update(self._parts(k))

    def written(self) -> Written:
        """Write all nodes that results need."""
        assignments, symbols = [], set()
        for k in self._order:
            kind, text = self._nodes[k][0], self._text(k)
            if kind == ATOM:
                symbols |= {self._nodes[k][1]} - {None}
            elif self._uses[k] > 1:
                assignments.append((_name(k), text))
                text = _name(k)
            else:
                self._inline[k] = PRODUCT if kind == SUM and len(self._nodes[k]) == 2 else kind
            self._texts[k] = text
        return Written(assignments, [self._scaled(*result) for result in self._results], symbols)

    def _parts(self, k: int) -> list[int]:
        kind, *parts = self._nodes[k]
        if kind in (SUM, ROOT):
            return [node for _, node in parts]
        return [] if kind == ATOM else parts[1:] if kind == CALL else parts

    def _postorder(self) -> list[int]:
        """Return the nodes that results need, each after its parts."""
        done: dict[int, None] = {}
        pending = [node for _, node in reversed(self._results)]
        while pending:
            missing = [part for part in self._parts(pending[-1]) if part not in done]
            if not missing:
                done[pending.pop()] = None
            else:
                pending += reversed(missing)
        return list(done)

    def _text(self, k: int) -> str:
        kind, *parts = self._nodes[k]
        match kind:
            case _ if k == ONE:
                return "1.0"
            case _ if kind == ATOM:
                return str(parts[0].name)
            case _ if kind == CALL:
                return f"({_NAME.sub(self._argument, parts[0])})"
            case _ if kind == ROOT:
                return f"sqrt({self._scaled(*parts[0])})"
            case _ if kind == SUM:
                text = "".join(self._signed(*term) for term in parts)
                return text.removeprefix(" + ") if text.startswith(" + ") else f"-{text.removeprefix(' - ')}"
        below = [node for node in parts if self._inline.get(node) == INVERSE] if kind == PRODUCT else [k]
        above = [self._factor(node) for node in parts if node not in below] if kind == PRODUCT else []
        divisors = (node for inverse in below for node in self._parts(inverse))
        parentheses = (f"({self._texts[node]})" if node in self._inline else self._texts[node] for node in divisors)
        return "/".join(["*".join(above or ["1.0"]), *parentheses])

    def _argument(self, name: re.Match[str]) -> str:
        """Return an argument of a call, within it if it is used nowhere else, so that only the selected case is computed."""
        node = int(name[1])
        return f"({self._texts[node]})" if node in self._inline else self._texts[node]

    def _factor(self, node: int) -> str:
        """Return a node as a factor of a product."""
        text = self._texts[node]
        return f"({text})" if self._inline.get(node) == SUM else text

    def _scaled(self, factor: Number, node: int) -> str:
        """Return a term."""
        if node == ONE:
            return _of_number(factor)
        if factor in (1, -1):
            return self._texts[node] if factor == 1 else f"-{self._factor(node)}"
        return f"{_of_number(factor)}*{self._factor(node)}"

    def _signed(self, factor: Number, node: int) -> str:
        """Return a term of a sum with its sign."""
        size = _size(factor)
        text = self._scaled(size, node)
        text = f"({text})" if size == 1 and self._inline.get(node) == SUM else text
        return f" {'-' if factor < 0 else '+'} {text}"


def _size(x: Number) -> Number:
    return -x if x < 0 else x


def _of_number(x: Number) -> str:
    return repr(float(x)) if isfinite(x) else f"float('{float(x)}')"
