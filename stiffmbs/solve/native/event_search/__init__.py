"""Events within steps, as compiled routines."""
