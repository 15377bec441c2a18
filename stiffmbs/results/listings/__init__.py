"""Listings of other programs, and differences of results from them."""
