"""The command line: `python -m mission run room.xml`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import NoReturn

from mission.recording_arguments import add_recording_commands

EXAMPLES = """\
examples:
  python -m mission run room.xml
  python -m mission run room.xml --door study_door=40 --seed 3 --out runs/try
  python -m mission run room.xml --obstacle=-1.5,-0.5 --obstacle 1,1.2,200
  python -m mission run my_flat.xml --set scanner.pattern=draft --max-scans 2
  python -m mission run room.xml --fail-under recall=0.97 --json > result.json
then:
  rerun runs/room-1/mission.rrd
"""

BENCH_EXAMPLES = """\
examples:
  python -m mission bench walls
  python -m mission bench walls --seed 0 1 2 3 4
  python -m mission bench walls --category specular --ablate highlights
  python -m mission bench walls --sweep alpha1 --jobs 8
  python -m mission bench walls --set scanner.pattern=draft --set detector.alpha3=0.04
"""

BUILDING_EXAMPLES = """\
examples:
  python -m mission bench building
  python -m mission bench building --seed 3 --set scanner.pattern=draft
"""

PLANNERS_EXAMPLES = """\
examples:
  python -m mission bench planners
  python -m mission bench planners --scene room.xml --seed 0 1 2 3 4
  python -m mission bench planners --scene my_flat.xml --planner nbs --planner frontier --jobs 2
  python -m mission bench planners --set planning.travel_cost=0.1 --set planning.max_scans=6
"""

SPEED_EXAMPLES = """\
examples:
  python -m mission bench speed
  python -m mission bench speed --part scans --repeats 9
  python -m mission bench speed --json > speed.json
"""
SPEED_PARTS = ("scans", "photographs", "detector", "missions", "start-up")
"""As in `mission.bench.speed.command.PARTS`."""

COVERAGE_HELP = """\
coverage is the share of a room's visible structure that its scans have a return of: of all 10 cm cells of its walls,
floor and ceiling that an exact scanner sees from any place in the room where the robot can stand. It is computed from
the scene for the tables; no planner reads it. Every room that the robot can get into (the start's, those of sites
start_2, start_3..., and those behind doors that stand wide enough) is explored on its own, without photographs.
"""
PLANNERS = ("nbs", "frontier", "random", "grid")
"""As in `planning.planner`."""


def main(arguments: list[str] | None = None) -> int:
    """Run a command line and return its exit status."""
    options = parser().parse_args(arguments)
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
    run.add_argument("--seed", type=_seed, default=0, metavar="N", help="seed of all noise (default: 0)")
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
    run.add_argument("--max-scans", type=_positive, metavar="N", help="at most so many scans a room")
    run.add_argument("--max-rooms", type=_positive, metavar="N", help="at most so many rooms")
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
    bench = kinds.add_parser("bench", help="measure how good the parts are", allow_abbrev=False)
    benches = bench.add_subparsers(title="benchmarks", dest="bench", required=True, metavar="NAME")
    _add_walls(benches)
    _add_building(benches)
    _add_planners(benches)
    _add_speed(benches)
    _add_recording(benches)
    return commands


def _add_viewers(run: OneLineParser) -> None:
    """Options to follow a mission while it runs."""
    live = run.add_argument_group("live", "follow the mission in Rerun viewers; its files are written all the same")
    live.add_argument("--view", action="store_true", help="open a viewer")
    live.add_argument("--connect", metavar="URL", help="stream to a viewer: rerun+http://HOST:9876/proxy")
    live.add_argument(
        "--serve",
        type=_port,
        nargs="?",
        const=9876,
        metavar="PORT",
        help="serve the mission to viewers of this machine (127.0.0.1), for as long as it runs (default port: 9876); "
        "then: rerun rerun+http://127.0.0.1:9876/proxy",
    )


def _add_walls(benches: argparse._SubParsersAction[OneLineParser]) -> None:
    walls = benches.add_parser(
        "walls",
        help="the detector on 27 generated walls with 35 doors",
        description="Scan generated walls in the paper's five categories, detect their doors, compare them with the "
        "truth, and print the paper's Tables 4 to 6 with its numbers beside ours.",
        epilog=BENCH_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    walls.add_argument(
        "--seed", type=_seed, nargs="+", default=[0], metavar="N", help="of the rooms and of all noise (default: 0)"
    )
    walls.add_argument(
        "--category",
        action="append",
        metavar="NAME",
        help="simple, occlusion, specular, semi-open or 'very complex'; may be repeated (default: all)",
    )
    walls.add_argument("--out", metavar="DIR", help="folder for the results (default: runs/bench-walls-<n>)")
    what = walls.add_mutually_exclusive_group()
    what.add_argument(
        "--ablate",
        choices=("highlights", "flash"),
        help="compare with a run that leaves a stage out; highlights is Table 5, of the specular category by default",
    )
    what.add_argument(
        "--sweep",
        choices=("delta", "alpha1", "alpha2", "alpha3", "sigma"),
        help="nine values of a parameter of the detector: Table 6",
    )
    _add_workers(walls)
    walls.add_argument("--cache", metavar="DIR", help="folder of scanned rooms (default: ~/.cache/door-mission)")
    _add_configuration(walls)


def _add_planners(benches: argparse._SubParsersAction[OneLineParser]) -> None:
    planners = benches.add_parser(
        "planners",
        help="next best scan beside nearest frontier, random and grid: scans, metres, coverage",
        description="Explore every room of the scenes with every planner, and print what each needed and saw.",
        epilog=COVERAGE_HELP + "\n" + PLANNERS_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    planners.add_argument(
        "--seed", type=_seed, nargs="+", default=[0, 1, 2], metavar="N", help="of all noise and chance (default: 0 1 2)"
    )
    planners.add_argument(
        "--scene",
        action="append",
        metavar="SCENE",
        help="MJCF file, as for run; may be repeated (default: room.xml, flat.xml and building.xml)",
    )
    planners.add_argument(
        "--planner", action="append", choices=PLANNERS, help="which; may be repeated (default: all of them)"
    )
    planners.add_argument("--out", metavar="DIR", help="folder for the results (default: runs/bench-planners-<n>)")
    _add_workers(planners)
    _add_configuration(planners)


def _add_recording(benches: argparse._SubParsersAction[OneLineParser]) -> None:
    recording = benches.add_parser(
        "recording",
        help="what recording costs: bytes a scan, wall clock, memory; and how fast it is read back",
        description="Run a mission, and print what its recordings cost beside what they may.",
        allow_abbrev=False,
    )
    recording.add_argument("--scene", default="room.xml", metavar="SCENE", help="as for run (default: room.xml)")
    recording.add_argument("--seed", type=_seed, default=0, metavar="N", help="of all noise (default: 0)")
    recording.add_argument("--out", metavar="DIR", help="folder for the results (default: runs/bench-recording-<n>)")
    _add_configuration(recording)


def _add_speed(benches: argparse._SubParsersAction[OneLineParser]) -> None:
    speed = benches.add_parser(
        "speed",
        help="beside the renderer alone, MuJoCo's rays, Open3D and mujoco-lidar",
        description="Time scans, photographs, detector, missions and start-up, each in turns with what it is compared "
        "with. The floor is what MuJoCo's renderer needs for the frames that the sensors are shown. Open3D and "
        "mujoco-lidar take part where they are installed.",
        epilog=SPEED_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    speed.add_argument("--part", action="append", choices=SPEED_PARTS, help="only this; may be repeated")
    speed.add_argument(
        "--repeats", type=_positive, default=5, metavar="N", help="measurements of each, after a first (default: 5)"
    )
    speed.add_argument("--out", metavar="DIR", help="folder for the results (default: runs/bench-speed-<n>)")
    speed.add_argument("--json", action="store_true", help="print result.json and nothing else")


def _add_workers(bench: OneLineParser) -> None:
    bench.add_argument(
        "--jobs", type=_positive, metavar="N", help="rooms at a time, up to 2 GB each (default: one a core)"
    )
    bench.add_argument(
        "--backend",
        choices=("loky", "dask", "ray"),
        default="loky",
        help="what runs them: processes here (loky, the default), or the Dask or Ray cluster that "
        "DASK_SCHEDULER_ADDRESS or RAY_ADDRESS names",
    )


def _add_configuration(bench: OneLineParser) -> None:
    bench.add_argument("--config", type=Path, metavar="FILE.toml", help="parameters, a table a stage")
    bench.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="one parameter, as for run; may be repeated"
    )


def _add_building(benches: argparse._SubParsersAction[OneLineParser]) -> None:
    building = benches.add_parser(
        "building",
        help="a mission in a building of five rooms, whose doors show nine faces",
        description="Run a mission in building.xml, compare every door with the truth from each room that sees it, and "
        "print the paper's Table 3 with its numbers beside ours.",
        epilog=BUILDING_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    building.add_argument("--seed", type=_seed, default=0, metavar="N", help="of all noise (default: 0)")
    building.add_argument("--out", metavar="DIR", help="folder for the results (default: runs/bench-building-<n>)")
    _add_configuration(building)


def _seed(text: str) -> int:
    return _whole(text, least=0)


def _port(text: str) -> int:
    port = _whole(text, least=1)
    if port > 65535:
        raise argparse.ArgumentTypeError(f"expected a port from 1 to 65535, got {text!r}")
    return port


def _positive(text: str) -> int:
    return _whole(text, least=1)


def _whole(text: str, *, least: int) -> int:
    if not text.lstrip("+").isdecimal() or int(text) < least:
        raise argparse.ArgumentTypeError(f"expected a whole number from {least}, got {text!r}")
    return int(text)


if __name__ == "__main__":
    sys.exit(main())
