"""The one base class for what a user can get wrong with a scene or a machine."""

from __future__ import annotations


class SimError(Exception):
    """A scene, a file or the machine does not allow what was asked. The message is one line: what, and where."""
