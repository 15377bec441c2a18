"""Commands to begin with: examples, a first scene, what is installed."""
