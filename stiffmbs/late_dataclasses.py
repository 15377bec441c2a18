"""Dataclasses of the command whose methods are generated on first use, as a short command uses few of its classes."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import wraps
from threading import RLock
from typing import Any

ATTRIBUTES = {
    "__dataclass_fields__": "", "__dataclass_params__": "", "__match_args__": "", "__init__": "", "__repr__": "repr",
    "__eq__": "eq", "__hash__": "eq", "__setattr__": "", "__delattr__": "",
}  # fmt: skip
"""Attributes of a frozen dataclass, and the option without which it does not have them."""
_LOCK = RLock()
_WAITING: dict[type, Callable[[], object]] = {}
"""Generation of the methods of each class that is not in use yet."""


class _OnFirstUse:
    """Attribute of a dataclass that is generated, with all others of its class, when any of them is read."""

    def __init__(self, owner: type, name: str) -> None:
        self.owner, self.name = owner, name

    def __get__(self, instance: object, described: type) -> Any:
        _complete(self.owner)
        found = next(vars(base)[self.name] for base in self.owner.__mro__ if self.name in vars(base))
        return found.__get__(instance, described) if hasattr(found, "__get__") else found


def generate_later(package: str) -> None:
    """Let the dataclasses that a package defines from now on generate their methods on first use."""
    generated = dataclasses.dataclass

    @wraps(generated)
    def decorator(described: type | None = None, /, **options: Any) -> Any:
        if described is None:
            return lambda described: decorator(described, **options)
        if described.__module__.partition(".")[0] != package or not options.get("frozen"):
            return generated(described, **options)
        _WAITING[described] = lambda: generated(described, **options)
        for name, option in ATTRIBUTES.items():
            if options.get(option, True) and name not in vars(described):
                setattr(described, name, _OnFirstUse(described, name))
        return described

    dataclasses.dataclass = decorator


def generate_now() -> None:
    """Generate the methods of all classes, and of later ones when they are defined, before other threads may use them."""
    dataclasses.dataclass = getattr(dataclasses.dataclass, "__wrapped__", dataclasses.dataclass)
    for described in list(_WAITING):
        _complete(described)


def _complete(described: type) -> None:
    with _LOCK:
        generation = _WAITING.pop(described, None)
        if generation is not None:
            for name, value in list(vars(described).items()):
                if isinstance(value, _OnFirstUse):
                    delattr(described, name)
            generation()
