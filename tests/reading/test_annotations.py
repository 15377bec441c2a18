"""Annotations of descriptions become types once, when a class is defined."""

from __future__ import annotations

import sys
from types import ModuleType

import pytest
from pydantic import create_model

from stiffmbs.elements.body import Body
from stiffmbs.errors import InputError
from stiffmbs.reading.fields import Described

SOURCE = """
from __future__ import annotations
from typing import ClassVar, TYPE_CHECKING
from stiffmbs.reading.fields import Described

if TYPE_CHECKING:
    from nowhere import Unknown

class First(Described):
    known: ClassVar[Unknown] = 1
    number: float = 0.0
    others: tuple[First, ...] = ()

class Second(First):
    first: First | None = None
    later: Later | None = None

class Later(Described):
    count: int = 0
"""


@pytest.fixture
def module(monkeypatch):
    """A module whose classes name themselves, later ones, and names of type checkers alone."""
    made = ModuleType("described")
    monkeypatch.setitem(sys.modules, "described", made)
    exec(SOURCE, vars(made))
    return made


def test_derived_classes_find_types_and_not_texts():
    """Pydantic compiles a text again for each derived class."""
    assert not any(isinstance(each, str) for each in Body.__annotations__.values())


def test_names_that_are_unknown_as_yet_are_found_on_first_use(module):
    found = module.Second(number=1, others=[{"number": 2}], first={"number": 3}, later={"count": 4})
    assert found.others == (module.First(number=2),)
    assert found.first == module.First(number=3) and found.later == module.Later(count=4)


def test_a_class_without_a_source_is_described_too():
    made = create_model("Made", __base__=Described, mass=(float, ...))
    assert made(mass=2).mass == 2.0


def test_a_name_that_stays_unknown_is_told_on_first_use():
    exec("class Wrong(Described):\n    mass: 'Nothing'", names := {"Described": Described, "__name__": __name__})
    with pytest.raises(InputError, match=r"Wrong.* not fully defined"):
        names["Wrong"](mass=1)
