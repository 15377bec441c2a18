"""Symbolic derivation with SymPy: frames, equations, derivatives and kernel sources.

SymPy's cache is enlarged, which speeds up the derivation of long equations.
"""

import os

_CACHE_SIZE = "SYMPY_CACHE_SIZE"

if _CACHE_SIZE not in os.environ:
    os.environ[_CACHE_SIZE] = "20000"
    import sympy  # noqa: F401

    del os.environ[_CACHE_SIZE]
