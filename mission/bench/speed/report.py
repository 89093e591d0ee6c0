"""What `bench speed` found: tables, result.json, a picture."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from mission.bench.chart import COLOURS, Axis, Chart
from mission.bench.speed import beams, photographs
from mission.bench.speed.beams import Caster
from mission.bench.speed.detecting import DetectorTimes
from mission.bench.speed.missions import MissionTime
from mission.bench.speed.timing import Timing
from mission.bench.tables import BenchTable
from mission.report import write_json
from mission.versions import versions


@dataclass
class SpeedReport:
    """All parts; those that were not asked for are empty."""

    repeats: int
    casters: dict[str, list[Caster]] = field(default_factory=dict)
    """By world."""
    shots: int = 0
    """Photographs of a turn."""
    photographs: dict[str, Timing] = field(default_factory=dict)
    """Of a turn."""
    detector: DetectorTimes | None = None
    missions: list[MissionTime] = field(default_factory=list)
    start_up: dict[str, Timing] = field(default_factory=dict)

    def tables(self) -> list[BenchTable]:
        """A table a part."""
        return list(self._tables())

    def _tables(self) -> Iterator[BenchTable]:
        if self.casters:
            yield self._beams()
        if self.photographs:
            yield self._photographs()
        if self.detector:
            yield self._detector(self.detector)
        if self.missions:
            yield self._missions()
        if self.start_up:
            rows = tuple((name, f"{t.median:.2f}", _percent(t.spread)) for name, t in self.start_up.items())
            yield BenchTable("Start-up", ("python -m mission ...", "seconds", "spread"), rows)

    def _beams(self) -> BenchTable:
        header = ("panorama_60", "world", "seconds", "spread", "M beams/s", "ours", "within 50 um", "off by 1 cm")
        rows = []
        for world, casters in self.casters.items():
            ours = next(caster for caster in casters if caster.name == beams.OURS)
            for caster in casters:
                rows.append(
                    (
                        caster.name,
                        world,
                        f"{caster.timing.median:.2f}",
                        _percent(caster.timing.spread),
                        f"{caster.beams_per_second / 1e6:.2f}",
                        f"{ours.beams_per_second / caster.beams_per_second:.2f} x",
                        "" if caster.within_50_um is None else f"{caster.within_50_um:.2%}",
                        "" if caster.beyond_1_cm is None else f"{caster.beyond_1_cm} of 10 000",
                    )
                )
        return BenchTable("Scans, beside exact rays", header, tuple(rows))

    def _photographs(self) -> BenchTable:
        ours = self.photographs[photographs.OURS]
        rows = tuple(
            (
                name,
                f"{timing.median:.2f}",
                _percent(timing.spread),
                f"{self.shots / timing.median:.1f}",
                f"{timing.median / ours.median:.2f} x",
            )
            for name, timing in self.photographs.items()
        )
        return BenchTable("Photographs", (f"a turn of {self.shots}", "seconds", "spread", "a second", "ours"), rows)

    @staticmethod
    def _detector(times: DetectorTimes) -> BenchTable:
        rows = [
            (f"{views} views, {times.area:.1f} m2", f"{1000 * t.median / times.area:.0f}", _percent(t.spread))
            for views, t in times.by_views.items()
        ]
        rows.append(("grows with views to the power of", f"{times.views_exponent:.2f}", ""))
        rows += [
            (f"2 views, {area:.1f} m2", f"{1000 * t.median / area:.0f}", _percent(t.spread))
            for area, t in times.by_area.items()
        ]
        rows.append(("grows with area to the power of", f"{times.area_exponent:.2f}", ""))
        rows += [(f"  {stage}", f"{1000 * s / times.area:.0f}", "4 views") for stage, s in times.stages.items()]
        return BenchTable("Detector", ("wall", "ms/m2", "spread"), tuple(rows))

    def _missions(self) -> BenchTable:
        rows: list[tuple[str, ...]] = []
        for mission in self.missions:
            bare = mission.bare_renders
            rows.append(
                (
                    f"{mission.scene}, {mission.pattern}",
                    f"{mission.seconds:.1f}",
                    "" if bare is None else f"{mission.seconds / bare:.2f} x bare renders",
                    f"{mission.peak_memory / 1e9:.2f} GB",
                )
            )
            for stage, seconds in mission.stages.items():
                rows.append((f"  {stage}", f"{seconds:.1f}", f"{seconds / mission.seconds:.0%}", ""))
            if len(mission.rooms) > 1:
                rows += [
                    (f"  room {number}", f"{seconds:.1f}", f"{seconds / max(scans, 1):.1f} s a scan", f"{scans} scans")
                    for number, scans, seconds in mission.rooms
                ]
        return BenchTable("Missions", ("scene", "seconds", "", ""), tuple(rows))

    def result(self) -> dict[str, Any]:
        """The content of result.json: flat ratios, each None if it was not measured, then all that is behind them."""
        times = self.detector
        groups: list[list[Caster]] = [*self.casters.values(), [], []]
        room, clutter = groups[:2]
        mission = self.missions[0] if self.missions else None
        help_time = self.start_up.get("--help")
        return {
            "bench": "speed",
            "scan_over_floor": _ratio(room, beams.FLOOR, beams.OURS),
            "scan_vs_embree_cluttered": _ratio(clutter, beams.OURS, beams.EMBREE),
            "scan_vs_multiray_cluttered": _ratio(clutter, beams.OURS, beams.MULTI_RAY),
            "scan_vs_mujoco_lidar_cluttered": _ratio(clutter, beams.OURS, beams.MUJOCO_LIDAR),
            "photo_over_floor": self.photographs[photographs.OURS].median / self.photographs[photographs.FLOOR].median
            if self.photographs
            else None,
            "mission_over_floor": mission.seconds / mission.bare_renders if mission and mission.bare_renders else None,
            "detector_ms_per_m2": 1000 * times.by_views[4].median / times.area if times else None,
            "detector_exponent": max(times.views_exponent, times.area_exponent) if times else None,
            "peak_bytes": mission.peak_memory if mission else None,
            "help_s": help_time.median if help_time else None,
            "repeats": self.repeats,
            "scans": {
                world: {
                    caster.name: {
                        "seconds": list(caster.timing.seconds),
                        "beams_per_second": caster.beams_per_second,
                        "within_50_um": caster.within_50_um,
                        "beyond_1_cm_of_10000": caster.beyond_1_cm,
                    }
                    for caster in casters
                }
                for world, casters in self.casters.items()
            },
            "photographs": {
                name: {"seconds": list(timing.seconds), "per_second": self.shots / timing.median}
                for name, timing in self.photographs.items()
            },
            "detector": times
            and {
                "area_m2": times.area,
                "seconds_by_views": {str(views): list(t.seconds) for views, t in times.by_views.items()},
                "seconds_by_area": {f"{area:.2f}": list(t.seconds) for area, t in times.by_area.items()},
                "views_exponent": times.views_exponent,
                "area_exponent": times.area_exponent,
                "stage_seconds": times.stages,
            },
            "missions": [asdict(mission) for mission in self.missions],
            "start_up": {name: list(timing.seconds) for name, timing in self.start_up.items()},
            "versions": versions(),
        }


def write_report(folder: Path, report: SpeedReport) -> None:
    """Write tables.md, result.json and, where scans were timed, scans.png."""
    (folder / "tables.md").write_text("\n".join(table.markdown() for table in report.tables()))
    write_json(folder / "result.json", report.result())
    if report.casters:
        _picture(report.casters).save(folder / "scans.png")


def _picture(casters: dict[str, list[Caster]]) -> Chart:
    """Beams per second of every method: a column a world."""
    fastest = max(c.beams_per_second for group in casters.values() for c in group) / 1e6
    chart = Chart(
        "Beams of a panorama per second: " + " | ".join(casters),
        Axis("world", 0, len(casters) + 1, range(1, len(casters) + 1)),
        Axis("million beams a second", 0, 1.1 * fastest, range(0, int(1.1 * fastest) + 1, 1 + int(fastest) // 8)),
    )
    names = list(dict.fromkeys(c.name for group in casters.values() for c in group))
    for number, name in enumerate(names):
        values = [
            (float(place), c.beams_per_second / 1e6)
            for place, group in enumerate(casters.values(), start=1)
            for c in group
            if c.name == name
        ]
        chart.line(values, colour=COLOURS[number % len(COLOURS)], label=name)
    return chart


def _ratio(casters: Sequence[Caster], one: str, other: str) -> float | None:
    """How many times as many beams a second the one method casts as the other."""
    speeds = {caster.name: caster.beams_per_second for caster in casters}
    return speeds[one] / speeds[other] if one in speeds and other in speeds else None


def _percent(share: float) -> str:
    return f"+-{share:.0%}"
