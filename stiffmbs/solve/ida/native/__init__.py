"""Compiled starts and restarts of IDA."""
