"""Starts of IDA: at consistent values, after events and breakpoints, and after jumps of inputs."""
