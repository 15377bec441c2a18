"""Listings of other programs, and how far results are from them."""
