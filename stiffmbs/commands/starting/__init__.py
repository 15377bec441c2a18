"""Commands for a first use: examples, a first scene, installed versions."""
