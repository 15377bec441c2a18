"""Elimination orders, dense blocks and factors of sparse matrices."""
