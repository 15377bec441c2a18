"""CasADi's equations and their Jacobian as machine code: a C compiler makes it once for all tolerances."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

INPUTS, OUTPUTS = ("t", "x", "z"), ("ode", "alg")
NAME = "equations"
FLAGS = ("-O1", "-march=native", "-fPIC", "-shared")
"""-O2 takes minutes for functions of tens of thousands of lines."""


def compiler() -> str | None:
    """The C compiler of this machine, if there is one."""
    return shutil.which("gcc") or shutil.which("cc")


def compiled(equations: dict[str, Any]) -> dict[str, Any]:
    """The same equations, for an integrator of CasADi, by calls of compiled functions.

    Parameters
    ----------
    equations : dict
        Symbols ``t``, ``x``, ``z`` and expressions ``ode``, ``alg``, the second of both where there are algebraic equations.
    """
    import casadi as ca

    given, found = ([name for name in names if name in equations] for names in (INPUTS, OUTPUTS))
    function = ca.Function(NAME, [equations[n] for n in given], [equations[n] for n in found], given, found)
    command = compiler()
    assert command is not None
    with tempfile.TemporaryDirectory() as folder:
        source, library = f"{NAME}.c", Path(folder) / f"{NAME}.so"
        code = ca.CodeGenerator(source)
        code.add(function)
        code.add(function.jacobian())
        code.generate(f"{folder}/")
        subprocess.run([command, *FLAGS, source, "-o", str(library), "-lm"], cwd=folder, check=True)
        loaded = ca.external(NAME, str(library))
    symbols = {name: ca.MX.sym(name, equations[name].size1()) for name in given}
    values = loaded.call(list(symbols.values()))
    return {**symbols, **dict(zip(found, values, strict=True))}
