"""Benchmarks: the numbers that the mission, the detector and the recordings are held to."""
