"""From a description to a `System`: equations derived by SymPy, kernels as machine code, residuals from tables."""
