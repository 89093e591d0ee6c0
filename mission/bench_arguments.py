"""The command lines of the benchmarks."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from mission.argument_types import positive, seed

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
"""What `bench speed` times."""

COVERAGE_HELP = """\
coverage is the share of a room's visible structure that its scans have a return of: of all 10 cm cells of its walls,
floor and ceiling that an exact scanner sees from any place in the room where the robot can stand. It is computed from
the scene for the tables; no planner reads it. Every room that the robot can get into (the start's, those of sites
start_2, start_3..., and those behind doors that stand wide enough) is explored on its own, without photographs.
"""
PLANNERS = ("nbs", "frontier", "random", "grid")
"""As in `planning.planner`."""


def add_benchmarks(kinds: Any) -> None:
    """Add the command `bench` with its benchmarks to the subparsers of the command line."""
    bench = kinds.add_parser("bench", help="measure how good the parts are", allow_abbrev=False)
    benches = bench.add_subparsers(title="benchmarks", dest="bench", required=True, metavar="NAME")
    _add_walls(benches)
    _add_building(benches)
    _add_planners(benches)
    _add_speed(benches)
    _add_recording(benches)


def _add_walls(benches: Any) -> None:
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
        "--seed", type=seed, nargs="+", default=[0], metavar="N", help="of the rooms and of all noise (default: 0)"
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


def _add_planners(benches: Any) -> None:
    planners = benches.add_parser(
        "planners",
        help="next best scan beside nearest frontier, random and grid: scans, metres, coverage",
        description="Explore every room of the scenes with every planner, and print what each needed and saw.",
        epilog=COVERAGE_HELP + "\n" + PLANNERS_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    planners.add_argument(
        "--seed", type=seed, nargs="+", default=[0, 1, 2], metavar="N", help="of all noise and chance (default: 0 1 2)"
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


def _add_recording(benches: Any) -> None:
    recording = benches.add_parser(
        "recording",
        help="what recording costs: bytes a scan, wall clock, memory; and how fast it is read back",
        description="Run a mission, and print what its recordings cost beside what they may.",
        allow_abbrev=False,
    )
    recording.add_argument("--scene", default="room.xml", metavar="SCENE", help="as for run (default: room.xml)")
    recording.add_argument("--seed", type=seed, default=0, metavar="N", help="of all noise (default: 0)")
    recording.add_argument("--out", metavar="DIR", help="folder for the results (default: runs/bench-recording-<n>)")
    _add_configuration(recording)


def _add_speed(benches: Any) -> None:
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
        "--repeats", type=positive, default=5, metavar="N", help="measurements of each, after a first (default: 5)"
    )
    speed.add_argument("--out", metavar="DIR", help="folder for the results (default: runs/bench-speed-<n>)")
    speed.add_argument("--json", action="store_true", help="print result.json and nothing else")


def _add_workers(bench: argparse.ArgumentParser) -> None:
    bench.add_argument(
        "--jobs", type=positive, metavar="N", help="rooms at a time, up to 2 GB each (default: one a core)"
    )
    bench.add_argument(
        "--backend",
        choices=("loky", "dask", "ray"),
        default="loky",
        help="what runs them: processes here (loky, the default), or the Dask or Ray cluster that "
        "DASK_SCHEDULER_ADDRESS or RAY_ADDRESS names",
    )


def _add_configuration(bench: argparse.ArgumentParser) -> None:
    bench.add_argument("--config", type=Path, metavar="FILE.toml", help="parameters, a table a stage")
    bench.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="one parameter, as for run; may be repeated"
    )


def _add_building(benches: Any) -> None:
    building = benches.add_parser(
        "building",
        help="a mission in a building of five rooms, whose doors show nine faces",
        description="Run a mission in building.xml, compare every door with the truth from each room that sees it, and "
        "print the paper's Table 3 with its numbers beside ours.",
        epilog=BUILDING_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    building.add_argument("--seed", type=seed, default=0, metavar="N", help="of all noise (default: 0)")
    building.add_argument("--out", metavar="DIR", help="folder for the results (default: runs/bench-building-<n>)")
    _add_configuration(building)
