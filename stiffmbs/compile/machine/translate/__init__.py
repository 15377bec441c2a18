"""Translator from a subset of Python to LLVM assembly, in place of numba.

The language of kernels and native routines has int64 and float64 numbers, pointers to them, views of tables,
arithmetic, comparisons, loops, conditions, the functions of `math`, and calls. A function may be given to another one,
which is translated for it. Its semantics are those of Python with
exceptions: division by zero gives infinity, integers have 64 bits, indices are not checked, ``and`` and ``or`` give
truth values, `floor` a float. A function returns one number or pointer, or nothing. A variable assigned both integers
and floats is a float.

Numbers of the module are constants, and so are the fields of its frozen dataclasses, such as ``SEARCH.margin``. Modules
that define them belong to a ``native`` folder: compiled code is cached by the text of these.
"""
