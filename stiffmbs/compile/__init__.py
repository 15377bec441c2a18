"""Compilation of a model to a `System`: equations derived with SymPy, kernels in machine code."""
