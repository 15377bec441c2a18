"""Directional derivatives of all terms with respect to state, time and element parameters.

Forward-mode differentiation of the kernels' source (Griewank and Walther, Evaluating Derivatives, 2nd ed. 2008, ch. 3):
each statement is followed by the statement for its derivative. SymPy is not used.
"""
