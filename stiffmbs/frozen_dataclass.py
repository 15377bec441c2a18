"""Frozen dataclasses that are defined quickly: a short run defines more than a hundred, and calls few of their methods.

The standard decorator compiles six methods for each class, which takes longer than to read the class from its file.
Here, frozen classes share their methods; ``__init__`` alone is compiled for a class, when it is first read.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, FrozenInstanceError, fields
from dataclasses import dataclass as compiled_dataclass
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(described=None, /, *, frozen=False, eq=True, repr=True):
        """Make a class a dataclass; parameters and methods are those of `dataclasses.dataclass`."""
        if described is None:
            return lambda described: dataclass(described, frozen=frozen, eq=eq, repr=repr)
        if not frozen:
            return compiled_dataclass(described, eq=eq, repr=repr)
        compiled_dataclass(described, init=False, eq=False, repr=False)
        methods = {"__init__": _InitWhenRead(described), "__setattr__": _assign, "__delattr__": _delete}
        methods |= {"__repr__": _represented} if repr else {}
        methods |= {"__eq__": _is_equal, "__hash__": _hash, "_compared": _compared(described)} if eq else {}
        for name, method in methods.items():
            if vars(described).get(name) is None:  # Python sets a hash of None in classes with an equality of their own
                setattr(described, name, method)
        return described


class _Factory:
    """Default of a parameter whose field has a default factory."""

    def __repr__(self) -> str:
        return "<factory>"


class _InitWhenRead:
    """Descriptor that compiles ``__init__`` of a dataclass and takes its place."""

    def __init__(self, described: type) -> None:
        self._described = described

    def __get__(self, instance: object, kind: type | None = None) -> Any:
        made = _init_of(self._described)
        self._described.__init__ = made  # type: ignore[misc]
        return made.__get__(instance, kind)


def _init_of(described: Any) -> Any:
    """Return ``__init__`` of a dataclass: it assigns the fields, and calls ``__post_init__``."""
    names: dict[str, Any] = {"__name__": described.__module__, "_put": object.__setattr__, "_factory": _Factory()}
    parameters, lines = ["self"], []
    for field in fields(described):
        name, value, default = field.name, field.name, ""
        if field.default_factory is not MISSING:
            names[f"_made_{name}"], default = field.default_factory, "=_factory"
            value = f"_made_{name}() if {name} is _factory else {name}" if field.init else f"_made_{name}()"
        elif field.default is not MISSING:
            names[f"_default_{name}"], default = field.default, f"=_default_{name}"
        if field.init:
            parameters.append(name + default)
        if field.init or value != name:  # other fields are attributes of the class
            lines.append(f"_put(self, {name!r}, {value})")
    lines += ["self.__post_init__()"] * hasattr(described, "__post_init__")
    exec(f"def __init__({', '.join(parameters)}): {'; '.join(lines) or 'pass'}", names)
    made = names["__init__"]
    made.__qualname__ = f"{described.__qualname__}.__init__"
    made.__annotations__ = {field.name: field.type for field in fields(described) if field.init} | {"return": None}
    return made


def _compared(described: Any) -> Callable[[Any], tuple[Any, ...]]:
    """Return a function for the values that equality and hashes depend on."""
    names = [field.name for field in fields(described) if field.compare]
    if len(names) > 1:
        return staticmethod(attrgetter(*names))
    return staticmethod(lambda instance: tuple(getattr(instance, name) for name in names))


def _is_equal(self: Any, other: Any) -> bool:
    if other.__class__ is not self.__class__:
        return NotImplemented
    return bool(self._compared(self) == self._compared(other))


def _hash(self: Any) -> int:
    return hash(self._compared(self))


@recursive_repr()
def _represented(self: Any) -> str:
    values = (f"{field.name}={getattr(self, field.name)!r}" for field in fields(self) if field.repr)
    return f"{type(self).__qualname__}({', '.join(values)})"


def _assign(self: Any, name: str, value: object) -> None:
    if _is_frozen(self, name):
        raise FrozenInstanceError(f"cannot assign to field {name!r}")
    object.__setattr__(self, name, value)


def _delete(self: Any, name: str) -> None:
    if _is_frozen(self, name):
        raise FrozenInstanceError(f"cannot delete field {name!r}")
    object.__delattr__(self, name)


def _is_frozen(instance: Any, name: str) -> bool:
    """Return True for a field, and for any attribute unless a derived class may add some."""
    return name in instance.__dataclass_fields__ or "__dataclass_fields__" in vars(type(instance))
