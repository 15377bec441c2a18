"""Dataclasses of the command have the methods of usual ones, generated on first use."""

import copy
import dataclasses
import pickle

import pytest

from stiffmbs import late_dataclasses


@dataclasses.dataclass(frozen=True)
class Usual:
    x: int
    y: list = dataclasses.field(default_factory=list)
    z: int = 3


@pytest.fixture
def late(monkeypatch):
    """Classes of this module, one of another, whose methods are not generated yet."""
    monkeypatch.setattr(dataclasses, "dataclass", dataclasses.dataclass)
    late_dataclasses.generate_later(__name__.partition(".")[0])
    late = dataclasses.dataclass

    @late(frozen=True)
    class Base:
        """Base."""

        x: int
        y: tuple = ()

    @late(frozen=True)
    class Derived(Base):
        z: int = 3

        def __repr__(self):
            return "own"

    @late(frozen=True, eq=False)
    class ById(Base):
        def __init__(self, x):
            super().__init__(x, (1,))

    @late
    class Changing:
        x: int = 0

    return Base, Derived, ById, Changing


def test_methods_are_generated_by_any_use(late):
    Base, Derived, ById, Changing = late
    assert Base in late_dataclasses._WAITING and Changing not in late_dataclasses._WAITING
    assert [field.name for field in dataclasses.fields(Derived)] == ["x", "y", "z"]
    assert Base not in late_dataclasses._WAITING  # with the fields of its base
    assert Derived(1) == Derived(1, (), 3) != Derived(2) and hash(Derived(1)) == hash(Derived(1))
    assert repr(Derived(1)) == "own" and repr(Base(1)).endswith("Base(x=1, y=())")
    assert dataclasses.replace(Derived(1), z=5).z == 5 and dataclasses.asdict(Base(1)) == {"x": 1, "y": ()}
    with pytest.raises(dataclasses.FrozenInstanceError):
        Derived(1).x = 2
    assert ById(1) == ById(1) and ById(1).y == (1,)  # as its base compares them


def test_objects_made_without_their_constructor_have_all_methods(late):
    Base, *_ = late
    one, other = Base.__new__(Base), Base.__new__(Base)
    one.__dict__.update(x=1, y=())
    other.__dict__.update(x=1, y=())
    assert one == other and hash(one) == hash(other)
    with pytest.raises(dataclasses.FrozenInstanceError):
        one.x = 3


def test_patterns_and_checks_work_before_first_use(late):
    Derived = late[1]
    assert dataclasses.is_dataclass(Derived)
    match Derived(1, (2,)):
        case Derived(x, y):
            assert (x, y) == (1, (2,))


def test_nothing_waits_where_other_threads_begin(late):
    late_dataclasses.generate_now()

    @dataclasses.dataclass(frozen=True)
    class Later:
        x: int

    assert not late_dataclasses._WAITING and late[1](1).z == Later(3).x


def test_classes_of_other_packages_are_not_touched(monkeypatch):
    monkeypatch.setattr(dataclasses, "dataclass", dataclasses.dataclass)
    late_dataclasses.generate_later("elsewhere")
    made = dataclasses.make_dataclass("Made", ["x"], frozen=True)
    assert made not in late_dataclasses._WAITING and pickle.loads(pickle.dumps(Usual(1))) == copy.copy(Usual(1))
