"""Trust in a run: the scene solved again, tighter and in another way; error bars, and what is in doubt."""
