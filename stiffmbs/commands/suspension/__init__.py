"""Commands for suspensions."""
