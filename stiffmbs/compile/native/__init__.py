"""Loops in the language of `stiffmbs.compile.translate`; imported only when they have to be compiled."""
