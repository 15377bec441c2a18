"""What compiling a kind leaves behind: the pattern of its terms and the source of its kernels, kept on disk.

The record is all that a later run needs, so that SymPy is imported only where a kind is met for the first time.
"""

from __future__ import annotations

import inspect
import json
import logging
import re
import sys
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cache, cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from ..cache.source_files import digest_of, python_files
from ..describe.element import Component, Element
from ..interrupts import uncollected
from .formula_shape import Shape
from .kind import Kind, with_place
from .machine import cache as store
from .machine.description import Description
from .terms import TERM_SETS

if TYPE_CHECKING:
    from .symbolic.derive import Derived

RARE = ("all_levels", "all_levels_tangent")
"""Term sets that one formulation alone uses, index1: a third of the work of all, done when it is first asked for."""

_INDENTED_IMPORT = re.compile(r"^[ \t]+from (\.+)(\w[\w.]*) import", re.MULTILINE)

LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True)
class KindRecord:
    """The compiled form of a kind, apart from its machine code.

    Attributes
    ----------
    n_equations, n_holonomic : int
        Constraint equations of one element, and how many of them, the first, have a position form.
    joint_equations : list of int
        Equations of each joint that it refers to.
    n_counters : int
        Angles of one element that count whole turns.
    laws : list of (str, int)
        What each of its arguments is given to: a function of `stiffmbs.compile.law_zones`, or ``table`` and the place of
        its offset among the element's numbers.
    patterns : dict
        For each term the (row, column) of its entries in the element's own block.
    sources : dict
        For each usual term set the source of its kernel; absent where the kind contributes nothing.
    losses : list of int or None
        Numbers of an element that must be zero for it to keep energy; None where nothing makes that certain.
    variation : list
        For each entry of C_q its summands: factors, columns and whether bounded (`stiffmbs.compile.symbolic.variation.Summand`).
    removable : list of bool
        For each equation with a position form whether it may be left out where its derivatives are constant.
    timed : list of bool
        For each equation whether time is in it.
    """

    n_equations: int
    n_holonomic: int
    joint_equations: list[int]
    n_counters: int
    laws: list[tuple[str, int]]
    patterns: dict[str, list[tuple[int, int]]]
    sources: dict[str, str]
    losses: list[int] | None
    variation: list[list[tuple[list[list[int]], list[int], bool]]]
    removable: list[bool]
    timed: list[bool]

    @cached_property
    def entries(self) -> defaultdict[str, int]:
        """Number of entries that one element has in each term."""
        return defaultdict(int, {term: len(pattern) for term, pattern in self.patterns.items()})

    def n_operations(self, term_set: str) -> int:
        """Number of arithmetic operators in the source of a kernel, those of its places among numbers included."""
        source = self.sources.get(term_set, "")
        return sum(map(source.count, "+-*/"))


def record_of(kind: Kind, place: str = "") -> KindRecord:
    """Read a kind's record from the cache, or derive it and keep it.

    Parameters
    ----------
    kind : Kind
    place : str, optional
        Its place among others that are asked for, such as ``2 of 7 kinds``; told while it is derived.
    """
    return _record_of(kind, Description(place))


@cache
def _record_of(kind: Kind, place: Description) -> KindRecord:
    entry = _entry(kind)
    record = _read(entry) if entry else None
    if record is not None:
        return record
    LOGGER.info("deriving %s", with_place(kind, place.words))
    with uncollected():
        record = _derived(kind)
    if entry:
        store.write(entry, json.dumps(asdict(record)).encode())
    return record


def _read(entry: str) -> KindRecord | None:
    """A record from the cache; None where there is none that can be read."""
    stored = store.read(entry)
    try:
        return None if stored is None else KindRecord(**json.loads(stored))
    except (ValueError, TypeError):
        return None


@cache
def source_of(kind: Kind, term_set: str) -> str | None:
    """The source of a kind's kernel for a term set; None where the kind contributes nothing."""
    record = record_of(kind)
    if term_set in RARE and any(record.patterns.get(term) for term in TERM_SETS[term_set]):
        return _rare_source(kind, term_set)
    return record.sources.get(term_set)


def _rare_source(kind: Kind, term_set: str) -> str:
    from .symbolic.generate import kernel_source

    entry = _entry(kind, term_set)
    stored = store.read(entry) if entry else None
    if stored is not None:
        return stored.decode()
    source = kernel_source(term_set, _terms(kind), "kernel")
    if entry:
        store.write(entry, source.encode())
    return source


@lru_cache(maxsize=4)
def _terms(kind: Kind) -> Derived:
    """The terms of a kind, for the kernels that are written of it one after the other."""
    from .symbolic.derive import derive

    return derive(kind)


def _derived(kind: Kind) -> KindRecord:
    from .symbolic.generate import kernel_source

    derived = _terms(kind)
    patterns = {term: [(entry.row, entry.column) for entry in entries] for term, entries in derived.terms.items()}
    sources = {
        term_set: kernel_source(term_set, derived, "kernel")
        for term_set, terms in TERM_SETS.items()
        if term_set not in RARE and any(derived.terms.get(term) for term in terms)
    }
    return KindRecord(
        derived.n_equations, derived.n_holonomic, [len(lam) for lam in derived.symbols.joint_lam],
        len(derived.symbols.element.angles), [law.of for law in derived.symbols.laws], patterns, sources, derived.losses,
        [[(list(map(list, part.factors)), list(part.columns), part.bounded) for part in parts] for parts in derived.variation],
        derived.removable, derived.timed,
    )  # fmt: skip


def _entry(kind: Kind, *part: str) -> str | None:
    """The cache's name for everything that the record, or a part of its own, follows from; None where the element's source
    cannot be read."""
    classes = [kind.element, *(found for _, shape in kind.fields for found in _classes_in(shape))]
    bases = [base for element in classes for base in element.__mro__ if _says_equations(base)]
    try:
        texts = _files(bases) if all(map(_is_shipped, bases)) else _equations(kind)
    except (OSError, TypeError):
        return None
    return store.name_of(
        store.RECORD,
        _own_files(),
        *texts,
        kind.element.__qualname__,
        repr(
            (
                kind.dimensions,
                kind.n_bodies,
                kind.n_joints,
                kind.n_states,
                kind.fields,
                kind.spins,
                kind.algebraic,
                kind.n_own,
            )
        ),
        *part,
    )


def _says_equations(base: type) -> bool:
    """Whether a class of an element may state equations: not one such as ``Rod[Marker]``, which only gives a generic class its marker.

    The module of such a class is the one that happened to ask for it first.
    """
    return issubclass(base, Element | Component) and base.__pydantic_generic_metadata__["origin"] is None


def _classes_in(shape: Shape) -> Iterator[type]:
    """The classes of the joints and components that a field, or a formula in it, refers to."""
    if shape and shape[0] in ("joint", "component"):
        yield shape[1]
    for part in shape:
        if isinstance(part, tuple):
            yield from _classes_in(part)


def _is_shipped(element: type) -> bool:
    return element.__module__.partition(".")[0] == __name__.partition(".")[0]


def _files(elements: list[type]) -> list[str]:
    """A digest of the files of classes of this package, and of what their equations may call."""
    return [digest_of([*(Path(inspect.getfile(element)) for element in elements), *sorted(_helpers(elements))])]


def _equations(kind: Kind) -> list[str]:
    """The equations of a user's own class as expressions: they may come from any module, variable or file of the user's."""
    from .symbolic.stated import text_of

    return [text_of(kind)]


def _helpers(elements: list[type]) -> set[Path]:
    """The files of the functions and classes that elements' equations may call: what their own modules import by name from
    the same package, at the top or where it is used."""
    found = set()
    for module in {element.__module__ for element in elements}:
        package = module.partition(".")[0]
        for member in vars(sys.modules[module]).values():
            called = inspect.isfunction(member) or inspect.isclass(member)
            if called and member.__module__.partition(".")[0] == package:
                found.add(Path(inspect.getfile(member)))
        found |= _imported_later(module)
    return found


@cache
def _imported_later(module: str) -> set[Path]:
    """The files that the functions of a module import from, relative to it."""
    file = Path(inspect.getfile(sys.modules[module]))
    imports = _INDENTED_IMPORT.findall(file.read_text(encoding="utf-8"))
    found = [file.parents[len(dots) - 1].joinpath(*name.split(".")).with_suffix(".py") for dots, name in imports]
    return {path for path in found if path.is_file()}


@cache
def _own_files() -> str:
    """A digest of what derives, and of what elements are described by."""
    from importlib.metadata import version

    here, describe = Path(__file__).parent, Path(__file__).parent.parent / "describe"
    folders = (
        here,
        here / "symbolic",
        here / "inputs",
        *(describe / name for name in ("", "formula", "units", "spatial")),
    )
    return f"{version('sympy')} {digest_of(path for folder in folders for path in python_files(folder))}"
