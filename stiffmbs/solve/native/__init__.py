"""Loops in the language of `stiffmbs.compile.machine.translate`; imported only when they have to be compiled."""
