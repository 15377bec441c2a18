"""The symbolic side: frames, equations and derivatives in SymPy, and the source of kernels."""
