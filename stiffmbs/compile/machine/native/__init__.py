"""Loops in the language of `stiffmbs.compile.machine.translate`; imported only for compilation."""
