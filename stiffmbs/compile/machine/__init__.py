"""Machine code: translation of native functions, LLVM compilation, cache, and pointer tables."""
