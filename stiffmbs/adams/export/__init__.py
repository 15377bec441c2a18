"""Export of scenes as Adams/Solver datasets."""
