"""The command lines of `replay`, `recover` and `compare`."""

from __future__ import annotations

import argparse
from typing import Any

REPLAY_EXAMPLES = """\
examples:
  python -m mission replay runs/room-1/mission.mcap
  python -m mission replay runs/room-1/mission.mcap --redetect
  python -m mission replay runs/room-1/mission.mcap --redetect --set detector.alpha1=0.4 --out runs/try

exit status:
  0 done    2 no recording of a mission, or a damaged one: what could be read is in the folder
  3 the mission could not be judged again    130 interrupted
"""
COMPARE_EXAMPLES = """\
example:
  python -m mission compare runs/room-1/mission.mcap runs/room-2/mission.mcap

exit status:
  0 nothing differs    1 something differs    2 no recording of a mission, or a damaged one
"""


def add_recording_commands(kinds: Any) -> None:
    """Add the commands that read recordings to the subparsers of the command line."""
    replay = kinds.add_parser(
        "replay",
        help="play a recording back, or judge its doors again",
        description="Play the events of a recorded mission back into new mission.rrd, doors.json and summary.json; or "
        "register, colour, detect and tie again from the recorded scans and photographs, and say how the doors differ. "
        "Neither needs the simulator.",
        epilog=REPLAY_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    replay.add_argument("recording", metavar="RECORDING.mcap", help="what a run wrote; may be cut off")
    replay.add_argument("--redetect", action="store_true", help="judge again, with the recorded parameters or others")
    replay.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="with --redetect: one parameter, such as detector.alpha1=0.4; may be repeated",
    )
    replay.add_argument("--out", metavar="DIR", help="folder for the results (default: runs/<name>-replay-<n>)")
    replay.add_argument("--quiet", action="store_true", help="say nothing but errors and what differs")
    recover = kinds.add_parser(
        "recover",
        help="save what can be read of a recording that is cut off or damaged",
        description="Write a clean recording with all events of a damaged one, up to where it is damaged.",
        allow_abbrev=False,
    )
    recover.add_argument("recording", metavar="RECORDING.mcap", help="the damaged one; it is not changed")
    recover.add_argument("--out", metavar="DIR", required=True, help="folder for the clean one, of the same name")
    recover.add_argument("--quiet", action="store_true", help="say nothing but errors")
    compare = kinds.add_parser(
        "compare",
        help="what differs between two recorded missions",
        description="Compare doors, angles, coverage, times, parameters and versions of two recorded missions.",
        epilog=COMPARE_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    compare.add_argument("first", metavar="A.mcap")
    compare.add_argument("second", metavar="B.mcap")
