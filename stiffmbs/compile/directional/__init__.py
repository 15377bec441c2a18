"""Directional derivatives of all terms: how they change as the state, time and the numbers of elements change together.

Forward differentiation of the kernels' own source (Griewank and Walther, Evaluating Derivatives, 2nd ed. 2008, ch. 3): each
statement is followed by the statement for its derivative.  Nothing is derived from SymPy for it.
"""
