"""Parts of explicit Runge-Kutta steps: their start, stages, error, end and interpolant."""
