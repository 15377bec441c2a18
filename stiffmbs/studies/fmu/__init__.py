"""Models as FMUs (functional mock-up units) for co-simulation."""
