"""Run functions of compiled code in Python, with records of plain numbers and arrays in place of tables.

The functions are Python functions, except for the built-in ones of the translator. These get a meaning in Python here: a pointer is
an array, an address of a cell or a function is the object itself, and a view of a table is the table.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from types import ModuleType
from typing import Any
from unittest.mock import patch

from stiffmbs.compile.machine.translate.values import Builtin

MEANING = {
    "shifted": lambda array, count: array[count:],
    "int32": int,
    "call_int": lambda function, arguments: function(*arguments),
    "call_float": lambda function, arguments: function(*arguments),
    "call_address": lambda function, argument: function(argument),
}
"""Meanings of built-in functions by name; all others, such as views, return their first argument."""


def _call(function: Builtin, *arguments: Any) -> Any:
    return MEANING.get(function.lower.__name__, lambda first, *_: first)(*arguments)


@contextmanager
def interpreted(module: ModuleType | None = None, **replaced: Any) -> Iterator[None]:
    """Give built-in functions their meaning in Python within a context, and replace some functions of a module."""
    with ExitStack() as stack:
        stack.enter_context(patch.object(Builtin, "__call__", _call))
        if module and replaced:
            stack.enter_context(patch.multiple(module, **replaced))
        yield
