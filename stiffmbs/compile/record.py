"""What compiling a kind leaves behind: the pattern of its terms and the source of its kernels, kept on disk.

The record is all that a later run needs, so that SymPy is imported only where a kind is met for the first time.
"""

from __future__ import annotations

import inspect
import json
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

from ..describe.element import Element
from . import cache as store
from .kind import Kind
from .terms import TERM_SETS


@dataclass(frozen=True)
class KindRecord:
    """The compiled form of a kind, apart from its machine code.

    Attributes
    ----------
    n_equations, n_holonomic : int
        Constraint equations of one element, and how many of them, the first, have a position form.
    joint_equations : list of int
        Equations of each joint that it refers to.
    patterns : dict
        For each term the (row, column) of its entries in the element's own block.
    sources : dict
        For each term set the source of its kernel; absent where the kind contributes nothing.
    """

    n_equations: int
    n_holonomic: int
    joint_equations: list[int]
    patterns: dict[str, list[tuple[int, int]]]
    sources: dict[str, str]


@cache
def record_of(kind: Kind) -> KindRecord:
    """Read a kind's record from the cache, or derive it and keep it."""
    key = _key(kind)
    stored = store.read(key) if key else None
    if stored is not None:
        return KindRecord(**json.loads(stored))
    record = _derived(kind)
    if key:
        store.write(key, json.dumps(asdict(record)).encode())
    return record


def _derived(kind: Kind) -> KindRecord:
    from .derive import derive
    from .generate import kernel_source

    derived = derive(kind)
    patterns = {term: [(entry.row, entry.column) for entry in entries] for term, entries in derived.terms.items()}
    sources = {
        term_set: kernel_source(term_set, derived, "kernel")
        for term_set, terms in TERM_SETS.items()
        if any(derived.terms.get(term) for term in terms)
    }
    return KindRecord(
        derived.n_equations, derived.n_holonomic, [len(lam) for lam in derived.symbols.joint_lam], patterns, sources
    )


def _key(kind: Kind) -> str | None:
    """A key of everything that the record follows from; None where the element's source cannot be read."""
    try:
        classes = [kind.element, *(shape[1] for _, shape in kind.fields if shape[0] == "joint")]
        bases = [base for element in classes for base in element.__mro__ if issubclass(base, Element)]
        own = [Path(inspect.getfile(base)) for base in bases]
        texts = [path.read_text(encoding="utf-8") for path in own]
    except (OSError, TypeError):
        return None
    return store.key_of(
        _compile_text(), *texts, kind.element.__qualname__, repr((kind.n_bodies, kind.n_joints, kind.fields))
    )


@cache
def _compile_text() -> str:
    from importlib.metadata import version

    rooms = (Path(__file__).parent, Path(__file__).parent.parent / "describe")
    files = [path for room in rooms for path in sorted(room.glob("*.py"))]
    return "\0".join([version("sympy"), *(path.read_text(encoding="utf-8") for path in files)])
