"""Recordings of a mission: the only package that knows Rerun and MCAP."""
