"""The command line: `python -m mission run room.xml`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import NoReturn

EXAMPLES = """\
examples:
  python -m mission run room.xml
  python -m mission run room.xml --door study_door=40 --seed 3 --out runs/try
  python -m mission run my_flat.xml --set scanner.pattern=draft --max-scans 2
  python -m mission run room.xml --fail-under recall=0.97 --json > result.json
then:
  rerun runs/room-1/mission.rrd
"""


def main(arguments: list[str] | None = None) -> int:
    """Run a command line and return its exit status."""
    options = parser().parse_args(arguments)
    try:
        from mission.run import run  # imports mujoco, rerun and the rest: not needed for --help

        return run(options)
    except KeyboardInterrupt:
        print("interrupted before the mission began", file=sys.stderr)
        return 130


class OneLineParser(argparse.ArgumentParser):
    """A parser that says what is wrong in one line, like every other error."""

    def error(self, message: str) -> NoReturn:
        """Exit with status 2."""
        self.exit(2, f"error: {message} (see {self.prog} --help)\n")


def parser() -> argparse.ArgumentParser:
    """The commands and their options."""
    commands = OneLineParser(
        prog="python -m mission",
        description="Robot scanning missions in simulation that find doors, and prove what they found.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    kinds = commands.add_subparsers(title="commands", required=True, metavar="COMMAND")
    run = kinds.add_parser(
        "run",
        help="run a mission in a scene",
        description="Scan a room with MoPAD until it is covered, detect its doors, compare them with the joints.",
        epilog=EXAMPLES
        + "\nexit status:\n  0 done    1 done, but below a --fail-under    2 bad command line, scene or file"
        "\n  3 the mission could not go on    130 interrupted (files are complete in every case but 2)\n",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    run.add_argument("scene", metavar="SCENE", help="MJCF file; a bare name is also looked up in assets/rooms/")
    run.add_argument(
        "--out", metavar="DIR", help="folder for the results, replaced if they exist (default: runs/<scene>-<n>)"
    )
    run.add_argument("--seed", type=_seed, default=0, metavar="N", help="seed of all noise (default: 0)")
    run.add_argument(
        "--door",
        action="append",
        default=[],
        metavar="NAME=DEG",
        help="open a door of the scene to an angle from closed; a wrong NAME lists the right ones; may be repeated",
    )
    run.add_argument("--keyframe", metavar="NAME", help="start from a keyframe of the scene (default: the first)")
    run.add_argument("--max-scans", type=_positive, metavar="N", help="at most so many scans")
    run.add_argument("--config", type=Path, metavar="FILE.toml", help="parameters, a table a stage")
    run.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="one parameter, such as detector.alpha1=0.4 or scanner.pattern=draft; may be repeated",
    )
    run.add_argument(
        "--fail-under",
        action="append",
        default=[],
        metavar="METRIC=VALUE",
        help="exit 1 if recall, precision, found (share of the doors) or coverage (of the walls) is below a VALUE "
        "of 0 to 1; may be repeated",
    )
    how = run.add_mutually_exclusive_group()
    how.add_argument("--quiet", action="store_true", help="say nothing but errors")
    how.add_argument("--json", action="store_true", help="print doors and summary as one JSON object, nothing else")
    return commands


def _seed(text: str) -> int:
    return _whole(text, least=0)


def _positive(text: str) -> int:
    return _whole(text, least=1)


def _whole(text: str, *, least: int) -> int:
    if not text.lstrip("+").isdecimal() or int(text) < least:
        raise argparse.ArgumentTypeError(f"expected a whole number from {least}, got {text!r}")
    return int(text)


if __name__ == "__main__":
    sys.exit(main())
