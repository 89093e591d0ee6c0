"""Write the buildings: `python -m mission.bench.scenes` renews assets/rooms/flat.xml and building.xml."""

from __future__ import annotations

import argparse
from pathlib import Path

import assets
from mission.bench.scenes.building import BUILDING
from mission.bench.scenes.flat import FLAT
from mission.bench.scenes.writing import written

HOUSES = (FLAT, BUILDING)


def main(arguments: list[str] | None = None) -> None:
    """Write all files."""
    parser = argparse.ArgumentParser(
        prog="python -m mission.bench.scenes",
        description="Write flat.xml and building.xml from their plans; what was edited by hand in them is replaced.",
    )
    rooms = assets.FOLDER / "rooms"
    parser.add_argument("--out", type=Path, default=rooms, metavar="DIR", help="where to (default: %(default)s)")
    folder = parser.parse_args(arguments).out
    folder.mkdir(parents=True, exist_ok=True)
    for house in HOUSES:
        path = folder / f"{house.name}.xml"
        path.write_text(written(house))
        print(path)


if __name__ == "__main__":
    main()
