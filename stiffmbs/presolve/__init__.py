"""Presolve: merged bodies, subsystems, and elimination of dependent coordinates."""
