"""Commands for suspensions and tyres."""
