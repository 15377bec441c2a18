"""Frozen dataclasses behave as those of the standard library."""

import ast
import copy
import dataclasses
import inspect
import pickle
from dataclasses import field
from pathlib import Path

import pytest

import stiffmbs
from stiffmbs.frozen_dataclass import dataclass

DECORATORS = {"here": dataclass, "standard": dataclasses.dataclass}


def _classes(decorator):
    """Return frozen classes that differ in what the decorator treats apart."""

    @decorator(frozen=True)
    class Numbers:
        a: int
        b: list = field(default_factory=list)
        c: float = field(default=2.0, compare=False)
        d: str = field(default="", repr=False)
        derived: int = field(init=False, default=3)
        found: dict = field(init=False, default_factory=dict)

        def __post_init__(self):
            object.__setattr__(self, "derived", self.a + 1)

    @decorator(frozen=True)
    class More(Numbers):
        e: tuple = ()

    @decorator(frozen=True)
    class One:
        a: float

    @decorator(frozen=True)
    class Nothing:
        pass

    @decorator(frozen=True, eq=False, repr=False)
    class ByIdentity:
        a: int = 0

    @decorator(frozen=True)
    class Own:
        a: int = 0

        def __eq__(self, other):
            return True

        def __repr__(self):
            return "own"

    class Derived(One):
        def __init__(self, a):
            super().__init__(a)
            self.b = 2 * a

    return {made.__name__: made for made in (Numbers, More, One, Nothing, ByIdentity, Own, Derived)}


CLASSES = {name: _classes(decorator) for name, decorator in DECORATORS.items()}
PARAMETERS = {
    "Numbers": [{"a": 1}, {"a": 1, "b": [2], "c": 3.0}, {"a": 1, "d": "x"}, {"a": 2}],
    "More": [{"a": 1}, {"a": 1, "e": (2,)}, {"a": 1, "c": 1.0}],
    "One": [{"a": 1.0}, {"a": 2.0}, {"a": float("nan")}],
    "Nothing": [{}],
    "ByIdentity": [{}, {"a": 1}],
    "Own": [{}, {"a": 1}],
    "Derived": [{"a": 1.0}, {"a": 2.0}],
}


def _outcome(call):
    """Return what a call returns, or its error."""
    try:
        return call()
    except (TypeError, AttributeError) as error:
        return type(error), str(error)


def _answers(kind, given):
    made = [kind(**each) for each in given]
    yield "equal", [[a == b for b in made] for a in made]
    yield "with another type", [a == object() for a in made]
    if kind.__name__ != "ByIdentity":
        yield "hash", [_outcome(lambda each=each: hash(each)) for each in made]
        yield "repr", [repr(each) for each in made]
    for each in made:
        yield "fields", [(f.name, f.type, f.init, f.compare) for f in dataclasses.fields(each)]
        yield "state", dict(vars(each))
        yield "dict", dataclasses.asdict(each)
        yield "copy", vars(copy.copy(each))
        yield "replaced", vars(dataclasses.replace(each))
        yield "assigned", _outcome(lambda each=each: setattr(each, "a", 5))
        yield "deleted", _outcome(lambda each=each: delattr(each, "a"))
        yield "added", _outcome(lambda each=each: setattr(each, "new", 5))
        yield "new", vars(each)
        yield "taken away", _outcome(lambda each=each: delattr(each, "new"))
    yield "signature", str(inspect.signature(kind))
    yield "unknown", _outcome(lambda: kind(**given[0], other=1))[0]
    yield "match", kind.__match_args__


@pytest.mark.parametrize("name", CLASSES["here"])
def test_a_class_answers_as_one_of_the_standard_library(name):
    here, standard = (_answers(CLASSES[decorator][name], PARAMETERS[name]) for decorator in DECORATORS)
    for found, expected in zip(here, standard, strict=True):
        assert repr(found) == repr(expected)


@dataclass(frozen=True)
class Pickled:
    """Class that pickle finds by its name."""

    a: int
    b: tuple[int, ...] = ()


def test_an_instance_passes_to_other_processes():
    assert pickle.loads(pickle.dumps(Pickled(1, (2, 3)))) == Pickled(1, (2, 3))


def test_methods_are_shared_and_the_constructor_is_compiled_when_it_is_first_read():
    first, second = _classes(dataclass), _classes(dataclass)
    assert first["One"].__eq__ is second["One"].__eq__ and first["One"].__repr__ is second["One"].__repr__
    assert not inspect.isfunction(vars(first["One"])["__init__"])
    first["One"](1.0)
    assert inspect.isfunction(vars(first["One"])["__init__"])


def test_all_frozen_dataclasses_of_the_package_are_of_this_kind():
    """Those of the standard library take six compilations each at the start of every command."""
    for path in sorted(Path(stiffmbs.__file__).parent.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if "@dataclass(frozen=True" not in text:
            continue
        imports = [node for node in ast.parse(text).body if isinstance(node, ast.ImportFrom)]
        (module,) = {node.module for node in imports if any(alias.name == "dataclass" for alias in node.names)}
        assert module == "frozen_dataclass", path
