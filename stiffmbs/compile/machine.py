"""Compiled functions: machine code from the cache, or compiled by numba and cached.

numba is imported only where something has to be compiled; cached code is loaded by llvmlite alone.
"""

from __future__ import annotations

import ctypes
import importlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from . import cache as store

_CTYPES: dict[str, Any] = {"int32": ctypes.c_int32, "int64": ctypes.c_int64, "float64": ctypes.c_double, "void": None}
_SIGNATURE = re.compile(r"^(\w+)\((.*)\)$")


@dataclass(frozen=True)
class Compiled:
    """A compiled function: its address for other compiled code, and a way to call it from Python.

    Pointers are passed as addresses (``array.ctypes.data``); the interpreter lock is released during a call.
    """

    address: int
    call: Callable[..., Any]


@cache
def compiled_source(source: str, name: str, signature: str) -> Compiled:
    """Compile a function from generated source, or load it from the cache.

    Parameters
    ----------
    source : str
        Python text that numba can compile; defines `name`.
    name : str
        The function's name.
    signature : str
        Such as ``void(int64, float64*)``.
    """

    def define() -> Callable[..., Any]:
        namespace: dict[str, Any] = {}
        exec(compile(source, f"<{name}>", "exec"), namespace)  # the text is made by this package from equations
        return namespace[name]

    return _loaded(store.key_of(source, _spline_text(), signature), define, signature)


@cache
def _spline_text() -> str:
    """The text of what generated sources call."""
    return (Path(__file__).parent / "native" / "spline.py").read_text(encoding="utf-8")


@cache
def compiled_routine(module: str, name: str, signature: str) -> Compiled:
    """Compile a function of one of the package's ``native`` modules, or load it from the cache."""

    def define() -> Callable[..., Any]:
        function = getattr(importlib.import_module(module), name)
        return getattr(function, "py_func", function)

    return _loaded(store.key_of(_native_text(), module, name, signature), define, signature)


@cache
def _native_text() -> str:
    """The text of all native modules and of what they are laid out by: a routine may be built of any of them."""
    package = Path(__file__).parent.parent
    files = [*sorted(package.glob("*/native/*.py")), package / "compile" / "layout.py"]
    return "\0".join(path.read_text(encoding="utf-8") for path in files)


def _loaded(key: str, define: Callable[[], Callable[..., Any]], signature: str) -> Compiled:
    symbol = f"stiffmbs_{key}"
    code = store.read(key)
    if code is None:
        code = _object_code(define(), symbol, signature)
        store.write(key, code)
    return _linked(code, symbol, signature)


def _new_target() -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=3,
        codemodel="jitdefault",
        jit=True,
    )


@cache
def _engine() -> Any:
    """The one engine that holds all compiled code of this process (it owns its target machine)."""
    import llvmlite.binding as llvm

    target = _new_target()
    module = llvm.parse_assembly("")
    module.triple = llvm.get_process_triple()
    return llvm.create_mcjit_compiler(module, target)


@cache
def _emitter() -> Any:
    return _new_target()


def _object_code(function: Callable[..., Any], symbol: str, signature: str) -> bytes:
    """Object code with one C function of the given name."""
    import llvmlite.binding as llvm
    import numba

    in_numbas_words = re.sub(r"(\w+)\*", r"CPointer(\1)", signature)
    built: Any = numba.cfunc(in_numbas_words, error_model="numpy")(function)
    module = llvm.parse_assembly(built.inspect_llvm())
    module.get_function(built._wrapper_name).name = symbol
    _close(module, symbol)
    return _emitter().emit_object(module)


def _close(module: Any, symbol: str) -> None:
    """Leave one function that needs nothing but the mathematical library, so that it can be loaded without numba.

    Once everything else is private, the optimiser sees that nothing raises and drops numba's error paths.
    """
    import llvmlite.binding as llvm

    for function in module.functions:
        if not function.is_declaration and function.name != symbol:
            function.linkage = llvm.Linkage.internal
    for variable in module.global_variables:
        if not variable.is_declaration:
            variable.linkage = llvm.Linkage.internal
    builder = llvm.create_pass_builder(_emitter(), llvm.create_pipeline_tuning_options(speed_level=3))
    builder.getModulePassManager().run(module, builder)
    missing = [f.name for f in module.functions if f.is_declaration and f.name.startswith(("numba", "Py", "NRT"))]
    if missing:
        raise RuntimeError(f"compiled code would need {', '.join(missing)}, expected code that cannot raise")


def _linked(code: bytes, symbol: str, signature: str) -> Compiled:
    import llvmlite.binding as llvm

    engine = _engine()
    if not engine.get_function_address(symbol):
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
    address = engine.get_function_address(symbol)
    return Compiled(address, _prototype(signature)(address))


def _prototype(signature: str) -> Any:
    match = _SIGNATURE.match(signature)
    assert match is not None, signature
    result, arguments = match.groups()
    types: list[Any] = [ctypes.c_void_p if "*" in a else _CTYPES[a.strip()] for a in arguments.split(",") if a.strip()]
    return ctypes.CFUNCTYPE(_CTYPES[result], *types)
