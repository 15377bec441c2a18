"""From functions in a small part of Python to LLVM's assembly: what numba would do, for as much of the language as is used here.

The part is what kernels and native routines are written in: numbers (int64 and float64) and pointers to them, tables
seen through views, cells in them, arithmetic, comparisons, loops, conditions, the functions of `math`, and calls of other such
functions.  What it means is what Python means by it, but for what Python would raise or need more memory for: a division by
zero gives infinity, integers have 64 bits, nothing checks an index, ``and`` and ``or`` give truth values, `floor` a
float.  A function gives one number or pointer, or nothing; a variable that is given integers and floats holds floats.
"""
