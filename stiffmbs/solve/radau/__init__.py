"""Radau IIA collocation methods of 3, 5 and 7 stages."""
