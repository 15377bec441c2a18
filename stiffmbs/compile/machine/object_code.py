"""Object code of this processor from LLVM assembly, at three levels of optimisation with bit-equal results."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from ...cache import entries
from ...cache.source_files import digest_of

if TYPE_CHECKING:
    from llvmlite import binding as llvm

FULL: Final = 3
SHORT: Final = 1
DRAFT: Final = 0
"""Levels of code generation. `FULL` has LLVM's usual passes, the others those of `_SHORT` alone. `DRAFT` is fast to compile."""
INLINED = 40
"""Instructions of functions that the passes of `_SHORT` inline: about as many as LLVM's usual ones do."""
INLINE = " alwaysinline"
"""Mark in the assembly of a function that they inline; the usual passes decide themselves."""
GENERIC: Final = "x86-64-v3"
"""Processor for which code in the library is compiled: every x86-64 of the last ten years has its instructions."""
_FEATURES = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
"""Instructions of `GENERIC` beyond those of every x86-64 processor."""
_SHORT = ("always_inliner", "dead_arg_elimination", "sroa", "simplify_cfg", "instruction_combine")
"""Passes for straight code, and for routines that spend their time in kernels; none transforms loops or vectorises."""


class Target(NamedTuple):
    """Platform of code for a shared library: LLVM's names of the platform and of its processor."""

    triple: str
    processor: str


def object_code(assembly: str, level: int, unrolled: bool, processor: str = "", target: Target | None = None) -> bytes:
    """Return the object code of a module.

    Parameters
    ----------
    assembly : str
        LLVM assembly, with functions of up to `INLINED` instructions marked by `INLINE`.
    level : int
        `FULL`, `SHORT` or `DRAFT`. No pass may reorder or contract floating-point operations.
    unrolled : bool
        Whether the usual passes unroll loops.
    processor : str
        Name of a processor as LLVM has it; by default this one.
    target : Target
        Platform of position-independent code for a shared library, whose functions are hidden outside of it; by
        default, code for this process.
    """
    import llvmlite.binding as llvm

    module = llvm.parse_assembly(assembly.replace(INLINE, "") if level == FULL else assembly)
    module.triple = target.triple if target else llvm.get_process_triple()
    options = llvm.create_pipeline_tuning_options(speed_level=level)
    options.loop_unrolling = unrolled
    emitter = _library_emitter(level, target) if target else _emitter(level, processor)
    if target:
        module.data_layout = str(emitter.target_data)
        for function in module.functions:
            if not function.is_declaration and function.linkage.name == "external":
                function.visibility = "hidden"
    builder = llvm.create_pass_builder(emitter, options)
    if level == FULL:
        passes = builder.getModulePassManager()
    else:
        passes = llvm.create_new_module_pass_manager()
        for name in _SHORT:
            getattr(passes, f"add_{name}_pass")()
    passes.run(module, builder)
    return emitter.emit_object(module)


@cache
def machine() -> str:
    """Return a digest of the processor and of the version of LLVM, on which machine code depends."""
    import llvmlite
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features().flatten()
    return entries.digest(llvm.get_process_triple(), llvm.get_host_cpu_name(), features, llvmlite.__version__)


@cache
def origin() -> str:
    """Return a digest of all that object code follows from besides its assembly."""
    return entries.digest(machine(), digest_of([Path(__file__)]))


def llvm_version() -> str:
    """Return the version of LLVM, on which code for other platforms depends besides the platform."""
    import llvmlite

    return str(llvmlite.__version__)


@cache
def generic_machine() -> str:
    """Return a digest of the processor of the library's code; empty if this processor cannot execute it."""
    import llvmlite.binding as llvm

    triple, features = llvm.get_process_triple(), llvm.get_host_cpu_features()
    has_all = triple.startswith("x86_64") and all(features.get(name) for name in _FEATURES)
    return entries.digest(triple, GENERIC) if has_all else ""


def new_target(level: int, processor: str = "") -> llvm.TargetMachine:
    """Return a target machine of LLVM for a processor, by default this one."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=processor or llvm.get_host_cpu_name(),
        features="" if processor else llvm.get_host_cpu_features().flatten(),
        opt=level,
        codemodel="jitdefault",
        jit=True,
    )


_emitter = cache(new_target)


@cache
def _library_emitter(level: int, target: Target) -> llvm.TargetMachine:
    """Return a target machine of LLVM for shared libraries of a platform."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    of_triple = llvm.Target.from_triple(target.triple)
    return of_triple.create_target_machine(
        cpu=target.processor, features="", opt=level, reloc="pic", codemodel="default"
    )
