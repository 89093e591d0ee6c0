"""Write the buildings: `python -m mission.bench.scenes` renews assets/rooms/flat.xml and building.xml."""

from __future__ import annotations

import assets
from mission.bench.scenes.building import BUILDING
from mission.bench.scenes.flat import FLAT
from mission.bench.scenes.writing import written

HOUSES = (FLAT, BUILDING)


def main() -> None:
    """Write all files."""
    for house in HOUSES:
        path = assets.FOLDER / "rooms" / f"{house.name}.xml"
        path.write_text(written(house))
        print(path)


if __name__ == "__main__":
    main()
