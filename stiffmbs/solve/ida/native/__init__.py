"""Compiled starts of IDA."""
