"""Object code linked into this process, and its functions for calls from Python."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

from .object_code import FULL, new_target

if TYPE_CHECKING:
    from llvmlite import binding as llvm

Signatures = tuple[tuple[str, str], ...]
"""Function names and their C signatures."""
_CTYPES: dict[str, type | None] = {
    "int32": ctypes.c_int32,
    "int64": ctypes.c_int64,
    "float64": ctypes.c_double,
    "void": None,
}
_SIGNATURE = re.compile(r"^(\w+)\((.*)\)$")


class Compiled(NamedTuple):
    """Compiled function: its address for other compiled code, and two ways to call it from Python.

    Pointers are passed as addresses (``array.ctypes.data``). `call` releases the interpreter lock; `short_call` keeps
    it, because acquiring the lock again may take longer than a call of a few microseconds. `unit`: all that the code follows from, and
    its source, from which other code can be made (`stiffmbs.compile.machine.compiler.in_shared_library`).
    """

    address: int
    call: Callable[..., Any]
    short_call: Callable[..., Any]
    name: str = ""
    unit: Any = None


def sealed(entry: str, code: bytes) -> bytes:
    """Return the content of an entry with object code: its name and the size of the code come first."""
    return f"{entry} {len(code)}\n".encode() + code


def unsealed(entry: str, stored: bytes | None) -> bytes | None:
    """Return the code of an entry; None if it is damaged or another's, because LLVM aborts the process on invalid object code."""
    code = (stored or b"").partition(b"\n")[2]
    return code if stored == sealed(entry, code) else None


def symbol(entry: str, name: str) -> str:
    """Return the name of a function in object code, unique in this process."""
    return f"stiffmbs_{entry}_{name}"


def linked(code: bytes, entry: str, signatures: Signatures) -> dict[str, Compiled] | None:
    """Return the functions of an entry by name; None if one is missing in the code."""
    import llvmlite.binding as llvm

    engine, found = _engine(), {}
    for name, signature in signatures:
        if not engine.get_function_address(symbol(entry, name)):
            engine.add_object_file(llvm.ObjectFileRef.from_data(code))
            engine.finalize_object()
        address = engine.get_function_address(symbol(entry, name))
        if not address:
            return None
        call, short_call = (made(*_prototype(signature))(address) for made in (ctypes.CFUNCTYPE, ctypes.PYFUNCTYPE))
        found[name] = Compiled(address, call, short_call, name)
    return found


@cache
def _engine() -> llvm.ExecutionEngine:
    """Return the engine that holds all compiled code of this process (it owns its target machine)."""
    import llvmlite.binding as llvm

    target = new_target(FULL)
    module = llvm.parse_assembly("")
    module.triple = llvm.get_process_triple()
    return llvm.create_mcjit_compiler(module, target)


def _prototype(signature: str) -> list[Any]:
    arguments, result = c_types(signature)
    return [_CTYPES[result], *(ctypes.c_void_p if "*" in kind else _CTYPES[kind] for kind in arguments)]


def c_types(signature: str) -> tuple[list[str], str]:
    """Return the C types of the arguments and of the result of a signature, such as ``void(int64, float64*)``."""
    match = _SIGNATURE.match(signature)
    assert match is not None, signature
    result, arguments = match.groups()
    return [kind.strip() for kind in arguments.split(",") if kind.strip()], result
