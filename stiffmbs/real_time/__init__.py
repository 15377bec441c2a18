"""Simulation in real time: steps of fixed length, their times, inputs and outputs over UDP, and their accuracy."""
