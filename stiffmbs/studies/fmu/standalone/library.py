"""The shared library of an FMU: object code of kernels and routines, and the C code of the interface, linked."""

from __future__ import annotations

import importlib.util
import platform
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ....compile.machine.compiler import Unit, in_shared_library
from ....compile.machine.layout import Addressed
from ....compile.machine.linking import Compiled
from ....compile.machine.object_code import GENERIC, Target
from ....compile.machine.routines import Routine
from ....errors import InputError

C_CODE = Path(__file__).parents[1] / "c"
HEADERS = C_CODE.with_name("fmi_headers")
"""Headers of the FMI standard, as published."""
SOURCES = ("instance.c", "fmu2.c", "fmu3.c")
OPTIONS = ("-shared", "-fPIC", "-O2", "-ffp-contract=off", "-fvisibility=hidden", "-fno-math-errno", "-s")
COMPILERS = ("cc", "gcc", "clang")


class Platform(NamedTuple):
    """Platform of an FMU's library.

    `folders`: its names in FMI 2.0 and 3.0. `suffix`: of the library. `target`: of the code. `zig`: name of the platform for zig, with the
    oldest C library.
    """

    folders: Mapping[str, str]
    suffix: str
    target: Target
    zig: str


PLATFORMS = {
    ("Linux", "x86_64"): Platform({"2.0": "linux64", "3.0": "x86_64-linux"}, ".so", Target("x86_64-unknown-linux-gnu", GENERIC), "x86_64-linux-gnu.2.17"),
}  # fmt: skip
"""Supported platforms, by the names of Python's module `platform`."""


def own_platform() -> Platform:
    """Return the platform of this process; raises InputError if FMUs without Python are not made for it."""
    found = PLATFORMS.get((platform.system(), platform.machine()))
    if found is None:
        raise InputError(
            f"FMUs without Python are made on Linux with x86-64 processors, and this is {platform.system()} on {platform.machine()}: "
            "write the FMU with Python (without --native)"
        )
    return found


def compiler(of: Platform) -> list[str]:
    """Return the command of a C compiler: zig, whose libraries run with older C libraries too, or that of the system."""
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc", "-target", of.zig, "-fno-sanitize=all"]
    for name in COMPILERS:
        if found := shutil.which(name):
            return [found]
    raise InputError(
        f"an FMU without Python needs a C compiler, and there is neither ziglang nor one of {', '.join(COMPILERS)}: "
        "pip install 'stiffmbs[fmu]'"
    )


class Linkable(NamedTuple):
    """Object code of some functions, and their names in it."""

    code: tuple[bytes, ...]
    names: tuple[str, ...]


def linkable(functions: Sequence[Addressed], of: Platform) -> Linkable:
    """Return the object code of functions, each unit once, and the name of each function."""
    prefixes: dict[str, str] = {}
    codes: list[bytes] = []
    names = []
    for function in functions:
        compiled = function.compiled if isinstance(function, Routine) else function
        assert isinstance(compiled, Compiled) and isinstance(compiled.unit, Unit)
        key = repr(compiled.unit.follows_from)
        if key not in prefixes:
            prefixes[key], code = in_shared_library(compiled.unit, of.target)
            codes.append(code)
        names.append(prefixes[key] + compiled.name)
    return Linkable(tuple(codes), tuple(names))


def linked_library(folder: Path, code: Sequence[bytes], texts: Mapping[str, str], of: Platform) -> bytes:
    """Compile and link a library in a folder; `texts` are files for the C code."""
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    objects = []
    for k, content in enumerate(code):
        objects.append(folder / f"{k}.o")
        objects[-1].write_bytes(content)
    library = folder / f"library{of.suffix}"
    sources = [C_CODE / name for name in SOURCES]
    command = [
        *compiler(of),
        *OPTIONS,
        f"-I{folder}",
        f"-I{C_CODE}",
        f"-I{HEADERS}",
        *map(str, [*sources, *objects]),
        "-lm",
        "-o",
        str(library),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise InputError(f"the C compiler {command[0]} failed: {done.stderr.strip()[:2000]}")
    return library.read_bytes()
