"""Cases of stress, one family per file; `CASES` holds them."""
