"""Models as FMUs, for programs that simulate several models together."""
