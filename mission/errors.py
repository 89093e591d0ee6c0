"""What can go wrong in a mission."""


class MissionError(Exception):
    """The mission cannot go on; the message says why in one line."""


class UsageError(MissionError):
    """The command line, a configuration or an output folder is wrong; the message says what and where in one line."""
