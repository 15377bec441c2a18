"""Equations of motion of scene files in NumPy alone, with which linear analyses, derivatives and stepwise runs are compared."""
