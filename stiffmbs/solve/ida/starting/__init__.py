"""Starts of IDA: at consistent values, behind events and breakpoints, and behind jumps of inputs."""
