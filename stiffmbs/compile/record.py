"""Records of derived kinds: patterns of terms and kernel sources, cached on disk.

A later run needs the record only, so SymPy is imported only for new kinds.
"""

from __future__ import annotations

import inspect
import json
import logging
import re
import sys
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cache, cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from ..cache import entries, library
from ..cache.installed import installed_version
from ..cache.source_files import digest_of, python_files
from ..elements.element import CompiledTerms, Component, Element
from ..interrupts import uncollected
from .formula_shape import Shape
from .kind import Kind, with_place
from .machine import compiler
from .machine.compiler import CALLS_WITH_LOOPS, Description, compiled_source, of_source
from .machine.linking import Compiled
from .machine.object_code import FULL, SHORT
from .machine.routines import fully_compiled
from .terms import KERNEL_SIGNATURE, TERM_SETS

if TYPE_CHECKING:
    from .symbolic.derive import Derived

RARE = ("all_levels", "all_levels_tangent")
"""Term sets of the formulation index1 only; derived on first use, as they are expensive."""
RECORDS = 512
"""Kinds whose records and sources are kept in memory, more than a large scene has. A car has about 60."""
DERIVED = 16
"""Kinds whose symbolic terms are kept in memory for their rare kernels. Those of a flexible body take 20 to 60 MB."""

_INDENTED_IMPORT = re.compile(r"^[ \t]+from (\.+)(\w[\w.]*) import", re.MULTILINE)

LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True)
class KindRecord:
    """Compiled form of a kind without its machine code.

    - `n_equations`, `n_holonomic`: number of constraint equations of one element, and of those with a position form,
      which come first.
    - `joint_equations`: number of equations of each joint that it refers to.
    - `counted`: for each turn counter of one element, the slot of the referenced joint and its coordinate; None for
      other angles.
    - `laws`: law of each argument: a function of `stiffmbs.compile.law_intervals`, or ``table`` and the index of its
      offset.
    - `patterns`: (row, column) of the entries of each term in the element's own block.
    - `sources`: kernel source of each common term set; absent if the kind contributes nothing.
    - `losses`: numbers of an element that must be zero for it to conserve energy; None if unknown.
    - `variation`: fields of the `stiffmbs.compile.symbolic.variation.Summand` objects of each entry of C_q.
    - `removable`: true for position equations that may be eliminated where their derivatives are constant.
    - `timed`: true for equations that depend on time or states.
    """

    n_equations: int
    n_holonomic: int
    joint_equations: list[int]
    counted: list[tuple[int, str] | None]
    laws: list[tuple[str, int]]
    patterns: dict[str, list[tuple[int, int]]]
    sources: dict[str, str]
    losses: list[int] | None
    variation: list[list[tuple[list[list[int]], list[int], bool]]]
    removable: list[bool]
    timed: list[bool]

    @property
    def n_counters(self) -> int:
        """Number of turn counters of one element."""
        return len(self.counted)

    @cached_property
    def entries(self) -> defaultdict[str, int]:
        """Number of entries of one element in each term."""
        return defaultdict(int, {term: len(pattern) for term, pattern in self.patterns.items()})

    def n_operations(self, term_set: str) -> int:
        """Return the number of arithmetic operators in the source of a kernel, including index arithmetic."""
        source = self.sources.get(term_set, "")
        return sum(map(source.count, "+-*/"))


def record_of(kind: Kind, place: str = "") -> KindRecord:
    """Return a kind's record from the cache, or derive and cache it.

    `place`: position in a list, such as ``2 of 7 kinds``; logged while it is derived.
    """
    return _record_of(kind, Description(place))


@lru_cache(RECORDS)
def _record_of(kind: Kind, place: Description) -> KindRecord:
    if hasattr(kind.element, "compiled_terms"):
        return _by_loops(kind)
    entry = _entry(kind)
    record = _read(entry) if entry else None
    if record is not None:
        return record
    LOGGER.info("deriving %s", with_place(kind, place.words))
    with uncollected():
        record = _derived(kind)
    forget()
    if entry:
        entries.write(of_installed(entry), packed(record))
    return record


def packed(record: KindRecord) -> bytes:
    """Return the content of the entry of a record."""
    return json.dumps({field.name: getattr(record, field.name) for field in fields(record)}).encode()


def _read(entry: str) -> KindRecord | None:
    """Return a record from the cache or the library; None if missing or unreadable."""
    stored = _stored(entry)
    try:
        return None if stored is None else KindRecord(**json.loads(stored))
    except (ValueError, TypeError):
        return None


def _stored(entry: str) -> bytes | None:
    return entries.read(of_installed(entry)) or library.read(entry)


def of_installed(entry: str) -> str:
    """Return the name in the cache of an entry that the installed SymPy derives; that in the library is of any."""
    return entries.name_of("record", entry, installed_version("sympy"))


@lru_cache(RECORDS * len(TERM_SETS))
def source_of(kind: Kind, term_set: str) -> str | None:
    """Return the source of a kind's kernel for a term set; None if the kind contributes nothing."""
    record = record_of(kind)
    if (
        term_set in RARE
        and not hasattr(kind.element, "compiled_terms")
        and any(record.patterns.get(term) for term in TERM_SETS[term_set])
    ):
        return _rare_source(kind, term_set)
    return record.sources.get(term_set)


def kernel_of(kind: Kind, term_set: str, place: str = "") -> Compiled | None:
    """Return the compiled kernel of a kind for a set of terms, or None; `place` as for `record_of`."""
    source = source_of(kind, term_set)
    if source is None:
        return None
    return compiled_source(
        source, "kernel", KERNEL_SIGNATURE, Description(with_place(kind, place)), _level(kind, source)
    )


def _level(kind: Kind, source: str) -> int:
    has_loops = hasattr(kind.element, "compiled_terms") or any(call in source for call in CALLS_WITH_LOOPS)
    return FULL if has_loops else SHORT


def in_library(kind: Kind) -> dict[str, bytes]:
    """Return the entries of the library for a kind: its record, sources and kernels of all sets of terms."""
    found: dict[str, bytes] = {}
    entry = None if hasattr(kind.element, "compiled_terms") else _entry(kind)
    if entry:
        found[entry] = packed(record_of(kind))
    for term_set in TERM_SETS:
        source = source_of(kind, term_set)
        if source is not None:
            if entry and term_set in RARE and (part := _entry(kind, term_set)):
                found[part] = source.encode()
            name, code = compiler.in_library(*of_source(source, "kernel", KERNEL_SIGNATURE, level=_level(kind, source)))
            found[name] = code
    return found


@fully_compiled()
def compile_kind(kind: Kind) -> None:
    """Compile and cache all kernels of a kind."""
    for term_set in TERM_SETS:
        kernel_of(kind, term_set)


def _rare_source(kind: Kind, term_set: str) -> str:
    entry = _entry(kind, term_set)
    stored = _stored(entry) if entry else None
    if stored is not None:
        return stored.decode()
    source = _rare_sources(kind)[term_set]
    if entry:
        entries.write(of_installed(entry), source.encode())
    return source


@lru_cache(RECORDS)
def _rare_sources(kind: Kind) -> dict[str, str]:
    """Return the sources of both rare kernels: a run needs them in passes over all kinds, whose terms are not all kept."""
    from .symbolic.generate import kernel_source  # loads SymPy

    return {term_set: kernel_source(term_set, _terms(kind), "kernel") for term_set in RARE}


@lru_cache(DERIVED)
def _terms(kind: Kind) -> Derived:
    """Return the terms of a kind, which its record and its rare kernels share."""
    from .symbolic.derive import derive

    return derive(kind)


def _places(terms: CompiledTerms, term_set: str) -> dict[str, int]:
    """Return the places of an element's terms in a set."""
    return {name: k for k, name in enumerate(TERM_SETS[term_set]) if name in terms.patterns}


def _by_loops(kind: Kind) -> KindRecord:
    """Return the record of a kind with kernels written as loops."""
    terms = kind.element.compiled_terms(kind)  # type: ignore[attr-defined]
    sources = {name: terms.source(places) for name in TERM_SETS if (places := _places(terms, name))}
    return KindRecord(0, 0, [], [], [], dict(terms.patterns), sources, None, [], [], [])


def forget() -> None:
    """Remove expressions from the caches of SymPy, whose reuse by other kinds is rare; those of a flexible body take 20 MB."""
    from sympy.core.cache import clear_cache

    from .symbolic.read import is_ready

    clear_cache()
    is_ready.cache_clear()


def _derived(kind: Kind) -> KindRecord:
    from .symbolic.generate import kernel_source

    derived = _terms(kind)
    element = derived.symbols.element
    patterns = {term: [(entry.row, entry.column) for entry in entries] for term, entries in derived.terms.items()}
    sources = {
        term_set: kernel_source(term_set, derived, "kernel")
        for term_set, terms in TERM_SETS.items()
        if term_set not in RARE and any(derived.terms.get(term) for term in terms)
    }
    return KindRecord(
        derived.n_equations, derived.n_holonomic, [len(lam) for lam in derived.symbols.joint_lam],
        [element.joint_angles.get(k) for k in range(len(element.angles))], [law.of for law in derived.symbols.laws], patterns, sources, derived.losses,
        [[(list(map(list, part.factors)), list(part.columns), part.bounded) for part in parts] for parts in derived.variation],
        derived.removable, derived.timed,
    )  # fmt: skip


def _entry(kind: Kind, *part: str) -> str | None:
    """Return the name of a record, or a part of it, from all its sources but SymPy; None if a source cannot be read."""
    classes = [kind.element, *(found for _, shape in kind.fields for found in _classes_in(shape))]
    bases = [base for element in classes for base in element.__mro__ if _says_equations(base)]
    try:
        is_shipped = all(base.__module__.partition(".")[0] == __name__.partition(".")[0] for base in bases)
        texts = _files(bases) if is_shipped else _equations(kind)
    except (OSError, TypeError):
        return None
    return entries.name_of(
        "record",
        _own_files(),
        *texts,
        kind.element.__qualname__,
        repr([getattr(kind, field.name) for field in fields(kind) if field.name != "element"]),
        *part,
    )


def _says_equations(base: type) -> bool:
    """Return True if a class may state equations, False for a parametrised generic such as ``Rod[Marker]``.

    The module of a parametrised class is that of its first use.
    """
    return issubclass(base, Element | Component) and base.__pydantic_generic_metadata__["origin"] is None


def _classes_in(shape: Shape) -> Iterator[type]:
    """Yield the classes of the joints and components that a field, or a formula in it, refers to."""
    if shape and shape[0] in ("joint", "component"):
        yield shape[1]
    for part in shape:
        if isinstance(part, tuple):
            yield from _classes_in(part)


def _files(elements: list[type]) -> list[str]:
    """Return digests of the files of shipped classes, and of the functions that their equations may call."""
    called = set().union(*(_called_by(module) for module in {element.__module__ for element in elements}))
    return [_content(file) for file in (*(_file(element.__module__) for element in elements), *sorted(called))]


@cache
def _file(module: str) -> Path:
    return Path(inspect.getfile(sys.modules[module]))


@cache
def _content(file: Path) -> str:
    """Return a digest of a file, which is read once for all kinds: its classes stay as they were imported."""
    return digest_of([file])


def _equations(kind: Kind) -> list[str]:
    """Return the equations of a user's class as expressions: their sources cannot be traced."""
    from .symbolic.element_equations import text_of

    return [text_of(kind)]


@cache
def _called_by(module: str) -> frozenset[Path]:
    package = module.partition(".")[0]
    members = [x for x in vars(sys.modules[module]).values() if inspect.isfunction(x) or inspect.isclass(x)]
    own = [member for member in members if member.__module__.partition(".")[0] == package]
    later = (_imported_later(name) for name in {module, *(member.__module__ for member in own)})
    return frozenset(map(Path, {inspect.getfile(member) for member in own})).union(*later)


@cache
def _imported_later(module: str) -> set[Path]:
    """Return the files that the functions of a module import from, relative to it."""
    file = _file(module)
    imports = _INDENTED_IMPORT.findall(file.read_text(encoding="utf-8"))
    found = [file.parents[len(dots) - 1].joinpath(*name.split(".")).with_suffix(".py") for dots, name in imports]
    return {path for path in found if path.is_file()}


@cache
def _own_files() -> str:
    """Return a digest of the modules for derivation and element description."""
    here, package = Path(__file__).parent, Path(__file__).parent.parent
    folders = (
        here,
        here / "symbolic",
        here / "inputs",
        *(package / "reading" / name for name in ("", "formula", "units")),
        *(package / "elements" / name for name in ("", "spatial")),
    )
    return digest_of(path for folder in folders for path in python_files(folder))
