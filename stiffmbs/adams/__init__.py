"""Readers and writers of Adams/Solver datasets (.adm) and command files (.acf)."""
