"""The command line: `python -m mission run room.xml`."""

from __future__ import annotations

import argparse
import atexit
import gc
import sys
from pathlib import Path
from typing import NoReturn

from mission.argument_types import port, positive, seed
from mission.bench_arguments import PLANNERS, add_benchmarks
from mission.memory import hold_little_memory
from mission.recording_arguments import add_recording_commands

EXAMPLES = """\
examples:
  python -m mission run room.xml
  python -m mission run room.xml --door study_door=40 --seed 3 --out runs/try
  python -m mission run room.xml --obstacle=-1.5,-0.5 --obstacle 1,1.2,200
  python -m mission run my_flat.xml --set scanner.pattern=draft --max-scans 2
  python -m mission run room.xml --fail-under recall=0.97 --json > result.json
  python -m mission run --resume runs/room-1
then:
  rerun runs/room-1/mission.rrd
"""


def main(arguments: list[str] | None = None) -> int:
    """Run a command line and return its exit status."""
    options = parser().parse_args(arguments)
    hold_little_memory()
    atexit.register(gc.freeze)  # or Python looks for garbage among all that it is about to give back, for 0.7 s
    try:
        if options.command == "bench":
            return _bench(options)
        if options.command != "run":
            return _read(options)
        from mission.run import run  # imports mujoco, rerun and the rest: not needed for --help

        return run(options)
    except KeyboardInterrupt:
        print(f"interrupted before the {options.command} began", file=sys.stderr)
        return 130


def _read(options: argparse.Namespace) -> int:
    """Commands that read recordings."""
    if options.command == "compare":
        from mission.compare import compare

        return compare(options)
    from mission.replay import recover, replay

    return replay(options) if options.command == "replay" else recover(options)


def _bench(options: argparse.Namespace) -> int:
    if options.bench == "planners":
        from mission.bench.planners.command import bench_planners

        return bench_planners(options)
    if options.bench == "speed":
        from mission.bench.speed.command import bench_speed

        return bench_speed(options)
    if options.bench == "recording":
        from mission.bench.recording.command import bench_recording

        return bench_recording(options)
    if options.bench == "building":
        from mission.bench.building.command import bench_building

        return bench_building(options)
    from mission.bench.walls.command import bench_walls

    return bench_walls(options)


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
    kinds = commands.add_subparsers(title="commands", dest="command", required=True, metavar="COMMAND")
    run = kinds.add_parser(
        "run",
        help="run a mission in a scene",
        description="Scan a building room by room with MoPAD, detect the doors, compare them with the joints.",
        epilog=EXAMPLES
        + "\nexit status:\n  0 done    1 done, but below a --fail-under    2 bad command line, scene or file"
        "\n  3 the mission could not go on    130 interrupted (files are complete in every case but 2)\n",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    run.add_argument(
        "scene", metavar="SCENE", nargs="?", help="MJCF file; a bare name is also looked up in assets/rooms/"
    )
    run.add_argument(
        "--resume",
        metavar="DIR",
        help="go on with the mission that was interrupted in this folder, as it was asked for; its recordings so far "
        "are kept as mission.interrupted-<n>.mcap and .rrd",
    )
    run.add_argument(
        "--out", metavar="DIR", help="folder for the results, replaced if they exist (default: runs/<scene>-<n>)"
    )
    run.add_argument("--seed", type=seed, default=0, metavar="N", help="seed of all noise (default: 0)")
    run.add_argument(
        "--door",
        action="append",
        default=[],
        metavar="NAME=DEG",
        help="open a door of the scene to an angle from closed; a wrong NAME lists the right ones; may be repeated",
    )
    run.add_argument(
        "--obstacle",
        action="append",
        default=[],
        metavar="X,Y[,SECONDS]",
        help="put a box of 0.4 x 0.4 x 0.8 m there during the run: at a mission time, or else as the robot sets off, "
        "but never on the robot; --obstacle=-1,2 where X is negative; may be repeated",
    )
    run.add_argument("--keyframe", metavar="NAME", help="start from a keyframe of the scene (default: the first)")
    run.add_argument("--max-scans", type=positive, metavar="N", help="at most so many scans a room")
    run.add_argument("--max-rooms", type=positive, metavar="N", help="at most so many rooms")
    run.add_argument(
        "--planner",
        choices=PLANNERS,
        help="how scan places are chosen: next best scan (the default) or a baseline, short for planning.planner",
    )
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
    _add_viewers(run)
    how = run.add_mutually_exclusive_group()
    how.add_argument("--quiet", action="store_true", help="say nothing but errors")
    how.add_argument("--json", action="store_true", help="print doors and summary as one JSON object, nothing else")
    add_recording_commands(kinds)
    add_benchmarks(kinds)
    return commands


def _add_viewers(run: OneLineParser) -> None:
    """Options to follow a mission while it runs."""
    live = run.add_argument_group("live", "follow the mission in Rerun viewers; its files are written all the same")
    live.add_argument("--view", action="store_true", help="open a viewer")
    live.add_argument("--connect", metavar="URL", help="stream to a viewer: rerun+http://HOST:9876/proxy")
    live.add_argument(
        "--serve",
        type=port,
        nargs="?",
        const=9876,
        metavar="PORT",
        help="serve the mission to viewers of this machine (127.0.0.1), for as long as it runs (default port: 9876); "
        "then: rerun rerun+http://127.0.0.1:9876/proxy",
    )


if __name__ == "__main__":
    sys.exit(main())
