"""Loops for `stiffmbs.compile.machine.translate`; imported only for compilation."""
