"""Compiled functions: machine code from the cache, or translated, compiled by LLVM and cached."""

from __future__ import annotations

import ctypes
import importlib
import logging
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from threading import RLock
from typing import Any, NamedTuple

from ...cache.source_files import digest_of, modules_within, python_files
from ...interrupts import uncollected
from . import cache as store
from .description import Description

LOGGER = logging.getLogger(__name__)
_CTYPES: dict[str, Any] = {"int32": ctypes.c_int32, "int64": ctypes.c_int64, "float64": ctypes.c_double, "void": None}
_ONE_AT_A_TIME = RLock()
"""Threads may need the same routine at once: one compiles it, the others find it."""
GEOMETRY = f"{__package__}.geometry"
"""The modules that sources of solids in contact call."""
SERIES = "rotation_vector("
"""A call in generated sources whose loop over a few terms is a polynomial once it is unrolled (bushings: a quarter less time)."""
_SIGNATURE = re.compile(r"^(\w+)\((.*)\)$")


class Compiled(NamedTuple):
    """A compiled function: its address for other compiled code, and two ways to call it from Python.

    Pointers are passed as addresses (``array.ctypes.data``); the interpreter lock is released during a `call`, and kept during a
    `short_call`: another thread that takes it for a while makes a call of a few microseconds wait for longer than it lasts.
    """

    address: int
    call: Callable[..., Any]
    short_call: Callable[..., Any]


Signatures = tuple[tuple[str, str], ...]
"""Names of functions and their C signatures."""


@dataclass(frozen=True)
class _Source:
    """Functions to be compiled together: their names in a namespace, which is made when asked for."""

    signatures: Signatures
    namespace: Callable[[], Mapping[str, Any]]
    of: str
    """What they belong to, in words."""
    text: str = ""
    """What defines them if that is in no file."""
    unrolled: bool = False
    """Whether loops are unrolled."""


def compiled_source(source: str, name: str, signature: str, of: str = "") -> Compiled:
    """Compile a function from generated source, or load it from the cache.

    Parameters
    ----------
    source : str
        Python text in the language of `stiffmbs.compile.machine.translate`; defines `name`.
    name : str
        The function's name.
    signature : str
        Such as ``void(int64, float64*)``.
    of : str, optional
        What it belongs to, told while it is compiled.
    """
    return _compiled_source(source, name, signature, Description(of))


@cache
def _compiled_source(source: str, name: str, signature: str, of: Description) -> Compiled:
    def namespace() -> dict[str, Any]:
        names: dict[str, Any] = {}
        exec(compile(source, f"<{name}>", "exec"), names)  # the text is made by this package from equations
        return names

    unrolled = SERIES in source
    entry = store.name_of(store.KERNEL, source, _language(), _called(GEOMETRY in source), signature, repr(unrolled))
    return _loaded(entry, _Source(((name, signature),), namespace, of.words, source, unrolled))[name]


@cache
def _called(with_geometry: bool) -> str:
    """A digest of what generated sources call."""
    here = Path(__file__).parent
    names = ("nonsmooth", "continuous_angle", "spline", "rotation_vector", "python_call")
    files = [here / "native" / f"{name}.py" for name in names]
    return digest_of(files + python_files(here / "geometry") * with_geometry)


@cache
def compiled_routines(module: str, signatures: Signatures, unrolled: bool) -> dict[str, Compiled]:
    """Compile functions of a ``native`` module together, or load them from the cache.

    Unrolled loops take LLVM a third longer.  Lists of a few entries are no faster by them (measured: 0 to 8 % slower on all
    examples), nor are products of dense blocks, but solutions with such blocks are (a car by blocks takes 6 to 8 % less).
    """
    entry = store.name_of(
        store.ROUTINE, _language(), _native(module.partition(".")[0]), module, repr((signatures, unrolled))
    )
    words = f"the routines {module.rpartition('.')[2]}"
    return _loaded(entry, _Source(signatures, lambda: vars(importlib.import_module(module)), words, unrolled=unrolled))


@cache
def _language() -> str:
    """A digest of the translator."""
    return digest_of(python_files(Path(__file__).parent / "translate"))


@cache
def _native(package: str) -> str:
    """Return a digest of the native modules of stiffmbs and of a package that calls them, and of their memory layout."""
    here = Path(__file__).parent
    folders = {here.parents[1], Path(importlib.import_module(package).__path__[0])}
    files = [file for folder in sorted(folders) for file in modules_within(folder, "native")]
    return digest_of([*files, here / "layout.py"])


def _loaded(entry: str, source: _Source) -> dict[str, Compiled]:
    with _ONE_AT_A_TIME:
        code = _unpacked(entry, store.read(entry))
        found = _linked(code, entry, source.signatures) if code else None
        if found is None:
            LOGGER.info("compiling %s", source.of)
            with uncollected():
                code = _object_code(source, _symbol(entry, ""))
            store.write(entry, _header(entry, code) + code)
            found = _linked(code, entry, source.signatures)
    assert found is not None, entry
    return found


def _unpacked(entry: str, stored: bytes | None) -> bytes | None:
    """The code of an entry; None where it holds anything else, as LLVM ends the process on what is no object code."""
    head, end, code = (stored or b"").partition(b"\n")
    return code if head + end == _header(entry, code) else None


def _header(entry: str, code: bytes) -> bytes:
    return f"{entry} {len(code)}\n".encode()


def _symbol(entry: str, name: str) -> str:
    """The name of a function in object code: no other of this process has it."""
    return f"stiffmbs_{entry}_{name}"


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


def _object_code(source: _Source, prefix: str) -> bytes:
    """Object code with a C function for each name, which begins with the prefix there."""
    import llvmlite.binding as llvm

    from .translate.unit import Entry, assembly

    namespace = source.namespace()
    entries = [Entry(namespace[name], prefix + name, *_c_types(signature)) for name, signature in source.signatures]
    module = llvm.parse_assembly(assembly(entries, source.text))
    module.triple = llvm.get_process_triple()
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_unrolling = source.unrolled
    builder = llvm.create_pass_builder(_emitter(), options)
    builder.getModulePassManager().run(module, builder)
    return _emitter().emit_object(module)


def _linked(code: bytes, entry: str, signatures: Signatures) -> dict[str, Compiled] | None:
    """The functions of an entry by their names; None where the code holds others."""
    import llvmlite.binding as llvm

    engine, found = _engine(), {}
    for name, signature in signatures:
        symbol = _symbol(entry, name)
        if not engine.get_function_address(symbol):
            engine.add_object_file(llvm.ObjectFileRef.from_data(code))
            engine.finalize_object()
        address = engine.get_function_address(symbol)
        if not address:
            return None
        call, short_call = (made(*_prototype(signature))(address) for made in (ctypes.CFUNCTYPE, ctypes.PYFUNCTYPE))
        found[name] = Compiled(address, call, short_call)
    return found


def _prototype(signature: str) -> list[Any]:
    """The types of the result and of the arguments."""
    arguments, result = _c_types(signature)
    return [_CTYPES[result], *(ctypes.c_void_p if "*" in kind else _CTYPES[kind] for kind in arguments)]


def _c_types(signature: str) -> tuple[list[str], str]:
    match = _SIGNATURE.match(signature)
    assert match is not None, signature
    result, arguments = match.groups()
    return [kind.strip() for kind in arguments.split(",") if kind.strip()], result
