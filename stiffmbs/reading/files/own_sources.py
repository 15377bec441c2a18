"""Digests of the user's Python code that the elements of a scene use.

The source file of each function and class belongs to the files of the scene. The loaded code has a separate digest,
because the file may have been edited since. User functions and classes that the code names are followed, as are values
in closures and modules.
"""

from __future__ import annotations

import functools
import hashlib
import inspect
import sys
import sysconfig
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import TYPE_CHECKING, Any

from .files_read import digest_of_file

if TYPE_CHECKING:
    from ...model.scene import Scene

PACKAGE = __name__.partition(".")[0]
PACKAGES = frozenset({"site-packages", "dist-packages"})
"""Folders of installed packages, also of another environment that this one extends."""
CODE = "code of "
"""Prefix of a file name for the digest of its loaded code."""
PLAIN = (int, float, complex, str, bytes, bool, type(None))


def own_sources(scene: Scene) -> dict[str, str]:
    """Return the digests of the code of user-defined elements by file; empty if all elements are of the package."""
    kinds = {type(element) for section in (scene.joints, scene.forces) for element in section.values()}
    own = {kind for kind in kinds if kind.__module__.partition(".")[0] != PACKAGE}
    return digests_of_code(own) if own else {}


def digests_of_code(found: Iterable[object]) -> dict[str, str]:
    """Return the digests by file of classes and functions, and of all user code that they use."""
    digests = {}
    for file, parts in _Walk(found).parts.items():
        digests[file] = digest_of_file(file)
        digests[CODE + file] = hashlib.sha256("\0".join(sorted(parts)).encode(errors="replace")).hexdigest()
    return digests


class _Walk:
    """Classes and functions that are reachable from given ones, each visited once.

    `parts`: texts from which the digest of each source file, or of a module without one, is computed.
    """

    def __init__(self, found: Iterable[object]) -> None:
        self.parts: defaultdict[str, list[str]] = defaultdict(list)
        self._visited: dict[int, object] = {}
        self._packages: set[str] = set()
        for each in found:
            self._packages.add(_module_of(each).partition(".")[0])
            self._visit(each)

    def _visit(self, found: object) -> None:
        if isinstance(found, staticmethod | classmethod | MethodType):
            self._visit(found.__func__)
        elif isinstance(found, property):
            self._visit_all(filter(None, (found.fget, found.fset)))
        elif isinstance(found, functools.partial):
            self._visit_all((found.func, *found.args, *found.keywords.values()))
        elif isinstance(found, type | FunctionType) and id(found) not in self._visited and self._is_own(found):
            self._visited[id(found)] = found
            if isinstance(found, type):
                self._visit_class(found)
            else:
                self._visit_function(found)

    def _visit_all(self, found: Iterable[object]) -> None:
        for each in found:
            self._visit(each)

    def _visit_class(self, found: type) -> None:
        self._visit_all(found.__mro__[1:])
        for name, member in sorted(vars(found).items()):
            if isinstance(member, FunctionType | staticmethod | classmethod | property):
                self._visit(member)
            elif not name.startswith("__") and (value := _plain(member)):
                self._add(found, f"{found.__qualname__}.{name} = {value}")
        for name, field in sorted(vars(found).get("__pydantic_fields__", {}).items()):
            self._add(found, f"{found.__qualname__}.{name}: {_plain(field.default)}")

    def _visit_function(self, found: FunctionType) -> None:
        given = (*(found.__defaults__ or ()), *(found.__kwdefaults__ or {}).values())
        cells = [cell.cell_contents for cell in found.__closure__ or () if _is_filled(cell)]
        names = [*_names(found.__code__)]
        held = [(name, found.__globals__[name]) for name in names if name in found.__globals__]
        for _, module in [*held]:
            if isinstance(module, ModuleType) and self._is_own_module(module.__name__):
                held += [(name, vars(module)[name]) for name in names if name in vars(module)]
        self._add(found, _text_of(found.__code__))
        for name, value in (*(("", value) for value in (*given, *cells)), *held):
            self._visit(value)
            self._add(found, f"{name} = {_plain(value)}")

    def _add(self, found: object, text: str) -> None:
        self.parts[_file_of(found)].append(text)

    def _is_own(self, found: object) -> bool:
        return self._is_own_module(_module_of(found))

    def _is_own_module(self, name: str) -> bool:
        """Return True for a module of the user: one that is not installed, or belongs to a user package."""
        top = name.partition(".")[0]
        if top in self._packages:
            return True
        file = getattr(sys.modules.get(name), "__file__", None)
        if not file or top == PACKAGE:
            return False
        path = Path(file)
        return PACKAGES.isdisjoint(path.parts) and not any(path.is_relative_to(place) for place in _installed())


@functools.cache
def _installed() -> tuple[Path, ...]:
    return tuple({Path(sysconfig.get_paths()[name]) for name in ("stdlib", "platstdlib")})


def _module_of(found: object) -> str:
    return str(getattr(found, "__module__", None) or "")


def _file_of(found: Any) -> str:
    """Return the source file of a class or function, or the name of its module if it has no file."""
    try:
        return inspect.getsourcefile(found) or f"module {_module_of(found)}"
    except (TypeError, OSError):
        return f"module {_module_of(found)}"


def _is_filled(cell: CellType) -> bool:
    try:
        return cell.cell_contents is not None
    except ValueError:
        return False


def _text_of(code: CodeType) -> str:
    """Return the code of a function and of its nested functions as text."""
    constants = [_text_of(found) if isinstance(found, CodeType) else _plain(found) for found in code.co_consts]
    return repr((code.co_name, code.co_code.hex(), code.co_names, code.co_varnames, constants))


def _names(code: CodeType) -> Iterator[str]:
    """Return the names used by a function and by its nested functions."""
    yield from code.co_names
    for found in code.co_consts:
        if isinstance(found, CodeType):
            yield from _names(found)


def _plain(found: Any) -> str:
    """Return data as text that is the same in every process, or an empty string for other objects."""
    if isinstance(found, PLAIN):
        return repr(found)
    if isinstance(found, tuple | list):
        return repr([_plain(part) for part in found])
    if isinstance(found, set | frozenset):
        return repr(sorted(_plain(part) for part in found))
    if isinstance(found, dict):
        return repr([(_plain(key), _plain(value)) for key, value in found.items()])
    if hasattr(found, "tobytes") and hasattr(found, "dtype") and not isinstance(found, type):
        return repr((str(found.dtype), found.shape, hashlib.sha256(found.tobytes()).hexdigest()))
    return repr(found.__name__) if isinstance(found, BuiltinFunctionType) else ""
