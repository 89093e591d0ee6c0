"""Files that the program ships: the robot, rooms and textures."""

from pathlib import Path

FOLDER = Path(__file__).parent
"""Where they are, in a checkout and in an installed wheel."""
