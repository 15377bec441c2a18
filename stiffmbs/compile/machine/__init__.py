"""Machine code: native functions translated, compiled by LLVM, kept in a cache, called with tables of addresses."""
