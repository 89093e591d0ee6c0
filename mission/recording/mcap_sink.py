"""The mission as an MCAP file: the machine's record, the same bytes for the same mission."""

from __future__ import annotations

import json
import os
from concurrent.futures import ThreadPoolExecutor
from functools import singledispatchmethod
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import foxglove
import numpy as np
from foxglove.mcap import MCAPCompression, MCAPWriteOptions
from foxglove.messages import (
    FrameTransforms,
    JointState,
    JointStates,
    Log,
    LogLevel,
    PosesInFrame,
    SceneEntity,
    SceneUpdate,
)
from numpy.typing import NDArray

from mission.errors import RecordingError
from mission.events import (
    Coloured,
    DoorsEvaluated,
    Drove,
    Event,
    Labelled,
    MissionStarted,
    Photographed,
    Planned,
    Registered,
    RoomEntered,
    RoomsTied,
    Structured,
)
from mission.joints import opening
from mission.recording import mcap_drawings as drawings
from mission.recording import mcap_messages as messages
from mission.recording.drawing import label_colours, thin
from mission.recording.kinds import PARTS
from mission.recording.mcap_messages import MAP, room_frame
from mission.recording.mcap_topics import FORMAT, PROFILE, open_channels, topic_of, topic_of_parts
from mission.recording.room_frames import RoomFrames
from mission.recording.sentences import level, sentence

if TYPE_CHECKING:
    from sim.laser_scan import LaserScan

EPOCH = 946_684_800_000_000_000
"""Mission time zero on the clock of the file: 2000-01-01 00:00:00 UTC [ns]. A mission has no date of its own."""
CLOUD_SPACING, CLOUD_READ = 0.02, 300_000
"""Of the clouds that viewers show: side of the cells that hold one point each [m], and points that are looked at."""
PER_STEP = 1_000
"""Added to an event's time for each earlier event [ns]: detection takes no mission time, but has an order."""


class McapSink:
    """Writes every event to an MCAP file as it happens, complete, and beside it what viewers show.

    Log times are mission time since `EPOCH` plus a microsecond an event, strictly increasing over the file; timestamps
    inside messages are mission time since `EPOCH` and no more. Nothing of wall clock, host or path goes in, and
    compression runs on a fixed number of threads, so two runs of one mission give the same bytes.
    """

    def __init__(self, path: Path) -> None:
        """Record into a file, which is overwritten."""
        self._path = path
        self._broken = False
        self._last_log_time = 0
        self._joints: tuple[str, ...] = ()
        self._frames = RoomFrames()
        self._walls: dict[int, list[SceneEntity]] = {}

    def __enter__(self) -> Self:
        self._context = foxglove.Context()  # never the global one, whose topics leak between recordings; kept alive
        options = MCAPWriteOptions(
            profile=f"{PROFILE}{FORMAT}", compression=MCAPCompression.Zstd, compression_level=1, compression_threads=2
        )
        self._writer = foxglove.open_mcap(
            self._path, allow_overwrite=True, context=self._context, writer_options=options
        )
        self._channels = open_channels(self._context)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._writer.close()
        except RuntimeError as failure:
            if not self._broken:
                raise RecordingError(self._path, failure) from failure

    def handle(self, event: Event) -> None:
        """Record one event; when this returns, the event is in the file and its chunk is closed.

        Raises:
            RecordingError: The file cannot be written; what comes after is lost.
        """
        if self._broken:
            return
        self._step = event.step
        self._now = EPOCH + event.time
        self._record(event)
        severity = LogLevel.Warning if level(event) == "WARN" else LogLevel.Info
        self._log(
            "/log",
            Log(timestamp=messages.timestamp(self._now), level=severity, message=sentence(event), name="mission"),
        )
        if type(event) in PARTS:
            for part in getattr(event, PARTS[type(event)]):
                self._log(topic_of_parts(type(event)), part)
        self._log(topic_of(type(event)), event)  # the last of its messages: whoever reads it has them all
        try:
            self._writer.flush()
        except RuntimeError as failure:
            self._broken = True
            raise RecordingError(self._path, failure) from failure

    @singledispatchmethod
    def _record(self, event: Event) -> None:
        """Write what an event carries; some say it all in the log."""

    @_record.register
    def _(self, event: MissionStarted) -> None:
        self._writer.write_metadata("mission", {"scene": event.scene, "seed": str(event.seed)})
        self._writer.write_metadata("versions", dict(sorted(event.versions.items())))
        self._attach("config.json", "application/json", json.dumps(event.config, indent=2))
        self._attach(event.scene, "application/xml", event.scene_xml)
        self._log("/tf", self._transforms(("tf#/", MAP, np.eye(4)), (MAP, "base", event.world_from_base)))
        self._log("/tf", self._transforms(("base", "scanner", event.base_from_scanner)))
        self._joints = tuple(door.name for door in event.true_doors)
        openings = np.array([opening(door) for door in event.true_doors])
        self._log("/truth/joints", self._joint_states(self._now, openings))
        self._log("/robot", SceneUpdate(entities=[drawings.robot(self._now, event.robot)]))

    @_record.register
    def _(self, event: RoomEntered) -> None:
        self._frames.follow(event)
        self._log("/tf", self._transforms((MAP, room_frame(event.room), event.world_from_room)))
        base = event.world_from_room @ event.world_from_base
        self._log("/tf", self._transforms((MAP, "base", base), (MAP, "true base", event.true_world_from_base)))

    @_record.register
    def _(self, event: RoomsTied) -> None:
        self._frames.follow(event)
        rooms = [(MAP, room_frame(room), pose) for room, pose in event.world_from_room.items()]
        self._log("/tf", self._transforms(*rooms))

    @_record.register
    def _(self, event: Photographed) -> None:
        scan = f"scan {event.scan_number}"
        frames = [f"{scan} photo {number}" for number in range(1, len(event.photos) + 1)]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            pictures = pool.map(lambda f, p: messages.photograph(self._now, f, p.image), frames, event.photos)
        for frame, photo, picture in zip(frames, event.photos, pictures, strict=True):
            self._log("/tf", self._transforms((scan, frame, photo.scanner_from_camera)))
            calibration = messages.calibration(self._now, frame, photo.image, photo.intrinsics)
            self._log("/camera/calibration", calibration)
            self._log("/camera/image", picture)

    @_record.register
    def _(self, event: Registered) -> None:
        frame = f"scan {event.scan_number}"
        self._log("/tf", self._transforms((room_frame(event.room), frame, event.world_from_scanner)))

    @_record.register
    def _(self, event: Coloured) -> None:
        view = event.view
        shown = thin(view.points_in_world, cell=CLOUD_SPACING, limit=CLOUD_READ, read=CLOUD_READ)
        cloud = messages.cloud(
            self._now,
            view.points_in_world[shown],
            view.colours[shown],
            view.coloured[shown],
            frame=room_frame(event.room),
        )
        self._log("/scan/points", cloud)

    @_record.register
    def _(self, event: Structured) -> None:
        walls = [drawings.wall(self._now, event.room, n, w) for n, w in enumerate(event.structure.walls, start=1)]
        self._walls[event.room] = walls
        entities = [wall for walls in self._walls.values() for wall in walls]
        self._log("/room/walls", SceneUpdate(deletions=[drawings.everything(self._now)], entities=entities))

    @_record.register
    def _(self, event: Labelled) -> None:
        model = event.voxels
        centres, colours = model.cells_in_world.astype(np.float32), label_colours(model.labels)
        known, frame = np.ones(len(centres), bool), room_frame(event.room)
        self._log("/room/voxel_centres", messages.cloud(self._now, centres, colours, known, frame=frame))

    @_record.register
    def _(self, event: Planned) -> None:
        grid = event.grid
        frame = room_frame(event.room)
        self._log("/plan/grid", messages.occupancy(self._now, grid.origin, grid.resolution, grid.cells, frame=frame))

    @_record.register
    def _(self, event: Drove) -> None:
        self._log_way(event)
        path = [messages.pose(drawings.on_floor(point)) for point in event.planned_path]
        planned = PosesInFrame(timestamp=messages.timestamp(self._now), frame_id=room_frame(event.room), poses=path)
        self._log("/drive/planned_path", planned)

    @_record.register
    def _(self, event: DoorsEvaluated) -> None:
        entities = [e for number, door in enumerate(event.doors) for e in drawings.door(self._now, door, number)]
        self._log("/doors/scene", SceneUpdate(entities=entities))

    def _log_way(self, event: Drove) -> None:
        """Poses, joints and Hokuyo scans of a leg, in the order of their times."""
        world_from_room = self._frames[event.room]
        scans = sorted(event.laser_scans, key=lambda scan: scan.time)
        for place, time in enumerate(event.times):
            while scans and scans[0].time <= time:
                self._log_laser(scans.pop(0))
            when = EPOCH + int(time)
            base, truth = world_from_room @ event.world_from_base[place], event.true_world_from_base[place]
            self._log("/tf", self._transforms((MAP, "base", base), (MAP, "true base", truth), when=when), when=when)
            self._log("/truth/joints", self._joint_states(when, event.true_door_angles[place]), when=when)
        for scan in scans:
            self._log_laser(scan)

    def _log_laser(self, scan: LaserScan) -> None:
        when = EPOCH + scan.time
        message = messages.laser_scan(when, "base", scan.base_from_laser, scan.angles, scan.ranges)
        self._log("/laser", message, when=when)

    def _log(self, topic: str, message: Any, *, when: int | None = None) -> None:
        """Write one message at the event's time, or at another one; later than the last in any case."""
        time = (self._now if when is None else when) + PER_STEP * self._step
        self._last_log_time = max(time, self._last_log_time + 1)
        self._channels[topic].log(message, log_time=self._last_log_time)

    def _attach(self, name: str, media_type: str, text: str) -> None:
        self._writer.attach(
            log_time=self._now, create_time=self._now, name=name, media_type=media_type, data=text.encode()
        )

    def _transforms(self, *frames: tuple[str, str, NDArray[np.float64]], when: int | None = None) -> FrameTransforms:
        """Frames as (parent, child, parent_from_child)."""
        time = self._now if when is None else when
        return FrameTransforms(transforms=[messages.transform(time, *frame) for frame in frames])

    def _joint_states(self, time: int, positions: NDArray[np.float64]) -> JointStates:
        joints = [JointState(name=n, position=float(p)) for n, p in zip(self._joints, positions, strict=True)]
        return JointStates(timestamp=messages.timestamp(time), joints=joints)
