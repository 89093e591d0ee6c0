"""What numbers on the command line may be."""

from __future__ import annotations

import argparse


def seed(text: str) -> int:
    """A whole number from 0."""
    return _whole(text, least=0)


def port(text: str) -> int:
    """A port of this machine."""
    number = _whole(text, least=1)
    if number > 65535:
        raise argparse.ArgumentTypeError(f"expected a port from 1 to 65535, got {text!r}")
    return number


def positive(text: str) -> int:
    """A whole number from 1."""
    return _whole(text, least=1)


def _whole(text: str, *, least: int) -> int:
    if not text.lstrip("+").isdecimal() or int(text) < least:
        raise argparse.ArgumentTypeError(f"expected a whole number from {least}, got {text!r}")
    return int(text)
