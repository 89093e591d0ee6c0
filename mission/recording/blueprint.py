"""How a Rerun recording opens: a tab for the mission, one a wall with doors, one for the results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import rerun.blueprint as rrb
from numpy.typing import NDArray

from mission.recording import entities, rerun_figures
from mission.recording.legends import COLUMN, ROW


@dataclass(frozen=True)
class WallTab:
    """What the tab of a wall needs to know."""

    room: int
    name: str
    """ "1.2" for the second wall of room 1."""
    views: int
    """How many scans saw it."""
    first_view: int | None
    """The one to open; None where there is none."""
    has_doors: bool
    shape: tuple[int, int]
    """Height and width of its images [px]."""


@dataclass(frozen=True, eq=False)
class Outlook:
    """Where the eye of the 3D view stands and looks."""

    eye: NDArray[np.float64]
    """(3,) in the world [m]."""
    target: NDArray[np.float64]
    """(3,) in the world [m]."""
    seen: NDArray[np.float64]
    """(N, 3) what is to be in view [m]."""


NO_LEGEND = rrb.PlotLegend(visible=False)


def outlook(points: NDArray[np.float64]) -> Outlook:
    """Look down at an angle on what spans some points (N, 3) of the world."""
    low, high = points.min(axis=0), points.max(axis=0)
    target = (low + high) / 2
    size = max(float(np.linalg.norm(high[:2] - low[:2])), 4.0)
    return Outlook(target + size * np.array([-0.22, -0.48, 0.72]), target, points)


def blueprint(view: Outlook, walls: Sequence[WallTab] = ()) -> rrb.Blueprint:
    """The layout of the whole recording; walls without doors are there, but folded away."""
    return tabbed([_mission(view), *(_wall(wall) for wall in walls), _results()], timeline="step")


def tabbed(tabs: Sequence[rrb.Container], *, timeline: str) -> rrb.Blueprint:
    """Tabs alone, all panels folded away, at the end of a timeline."""
    return rrb.Blueprint(
        rrb.Tabs(*tabs, active_tab=0),
        rrb.TimePanel(timeline=timeline, play_state="following", state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_views=False,
        auto_layout=False,
    )


def _mission(view: Outlook) -> rrb.Container:
    eye = rrb.EyeControls3D(position=view.eye, look_target=view.target, eye_up=(0, 0, 1))
    hidden = rrb.EntityBehavior(visible=False)
    not_here = [f"- {entity}/**" for entity in (entities.SHOTS, entities.MAP, f"{entities.CAMERA}/doors")]
    room = rrb.Spatial3DView(
        origin=entities.WORLD,
        contents=["$origin/**", *not_here],
        overrides={entities.CEILINGS: hidden},
        eye_controls=eye,
        line_grid=False,
        name="Room",
    )
    on_demand = [
        _map(eye, "Voxel labels", entities.VOXELS),
        _map(eye, "Clutter", entities.CLUTTER),
        _map(eye, "Occupancy grid", entities.GRID),
    ]
    photo = rrb.Spatial2DView(origin=entities.CAMERA, name="Photograph")
    graph = rrb.GraphView(origin=entities.GRAPH, name="Rooms and doors")
    side = rrb.Vertical(rrb.Tabs(photo, graph, active_tab=0), _scatter())
    lanes = rrb.StateTimelineView(
        origin="/", contents=[entities.ACTIVITY, f"{entities.DOOR_STATES}/**"], name="What the mission does"
    )
    key = rrb.TextDocumentView(origin=entities.KEY, name="What is what")
    above = rrb.Horizontal(rrb.Tabs(room, *on_demand, active_tab=0), side, column_shares=[5, 2])
    below = rrb.Horizontal(lanes, rrb.Tabs(_log(), key, active_tab=0), column_shares=[5, 4])
    return rrb.Vertical(above, below, row_shares=[3, 1], name="Mission")


def _map(eye: rrb.EyeControls3D, name: str, shown: str) -> rrb.View:
    """What the planner thinks of the room, without the cloud, which would bury it."""
    contents = [f"{entity}/**" for entity in (shown, entities.WALLS, entities.ROBOT, entities.DRIVEN, entities.PLANS)]
    return rrb.Spatial3DView(origin=entities.WORLD, contents=contents, eye_controls=eye, line_grid=False, name=name)


def _wall(wall: WallTab) -> rrb.Container:
    """The paper's stages from left to right, top to bottom."""
    root = entities.stages(wall.name)
    merged = f"+ {root}/merged/colour"
    area = f"+ {root}/wall_area"
    doors = _image(wall, "Merged (4.2) and the doors found", merged, f"+ {root}/merged/doors/**")
    openings = _image(wall, "Openings (5)", f"+ {root}/openings/**", f"- {root}/openings/visibility/**", below=ROW)
    edges = _image(wall, "Edges (6.2)", f"+ {root}/edges/**", below=ROW)
    candidates = _image(
        wall, "Candidates (6.2), accepted or rejected by", merged, f"+ {root}/candidates/**", beside=COLUMN
    )
    if not wall.has_doors:  # folded away, and less of it: a building has dozens, and a viewer opens them all
        return rrb.Grid(doors, openings, edges, candidates, grid_columns=2, name=f"Wall {wall.name}", visible=False)
    stages = rrb.Grid(
        doors,
        _image(wall, "Depth from the wall plane", f"+ {root}/merged/depth/**", below=ROW),
        rrb.Tabs(
            openings,
            _image(wall, "What the beams met", f"+ {root}/openings/visibility/**", below=ROW),
            active_tab=0,
        ),
        _image(wall, "Wall area (6.1): clusters of seeds", f"{area}/clusters", f"{area}/seeds/**", below=ROW),
        _image(wall, "Wall area (6.1): on the wall", merged, f"{area}/mask/**", below=ROW),
        edges,
        candidates,
        rrb.Spatial2DView(origin=f"{entities.SHOTS}/{wall.name}", name="Photograph with the doors"),
        grid_columns=2,
    )
    views = rrb.Tabs(*(_view(wall, number) for number in range(wall.views)), active_tab=wall.first_view)
    return rrb.Horizontal(views, stages, column_shares=[1, 2], name=f"Wall {wall.name}")


def _view(wall: WallTab, number: int) -> rrb.Container:
    """Section 4 for one scan."""
    view = f"{entities.stages(wall.name)}/view/{number}"
    return rrb.Vertical(
        _image(wall, "Seen", f"+ {view}/colour"),
        _image(wall, "Highlights (4.1)", f"+ {view}/colour", f"+ {view}/highlights/**", below=ROW),
        _image(wall, "Inpainted (4.2)", f"+ {view}/inpainted"),
        name=f"View {number + 1}",
    )


def _image(wall: WallTab, name: str, *contents: str, below: float = 0.0, beside: float = 0.0) -> rrb.View:
    """Images of a wall, with room for legends below and beside them [heights of the image]."""
    height, width = wall.shape
    bounds = rrb.VisualBounds2D(x_range=(0, width + beside * height), y_range=(0, (1 + below) * height))
    return rrb.Spatial2DView(
        origin=entities.stages(wall.name), contents=list(contents), name=name, visual_bounds=bounds
    )


def _results() -> rrb.Container:
    summary = rrb.TextDocumentView(origin=entities.SUMMARY, name="Summary")
    configuration = rrb.TextDocumentView(origin=entities.CONFIGURATION, name="Configuration")
    detector, mission = "Detector: time per stage", "Mission: time per stage (wall clock)"
    figures = rrb.Grid(
        rrb.Spatial2DView(origin=entities.ERRORS, name="Angle error", visual_bounds=rerun_figures.BARS),
        rrb.Spatial2DView(origin=entities.COVERED, name="Coverage per scan", visual_bounds=rerun_figures.COVERAGE),
        rrb.Spatial2DView(origin=entities.MISSION_STAGES, name=mission, visual_bounds=rerun_figures.BARS),
        rrb.Spatial2DView(origin=entities.STAGES, name=detector, visual_bounds=rerun_figures.BARS),
        rrb.Tabs(_angles(), _percent(), active_tab=0),
        rrb.TimeSeriesView(origin=entities.MEMORY, name="Memory [MB], most so far", plot_legend=NO_LEGEND),
        grid_columns=2,
    )
    return rrb.Horizontal(summary, figures, configuration, column_shares=[7, 9, 3], name="Results")


def _scatter() -> rrb.View:
    return rrb.Spatial2DView(
        origin=entities.SCATTER, name="Opening angle: estimate against joint", visual_bounds=rerun_figures.ANGLES
    )


def _angles() -> rrb.View:
    return rrb.TimeSeriesView(
        origin=entities.ANGLES,
        name="Opening angles [deg]",
        axis_y=rrb.ScalarAxis(range=(-5, 110)),
        plot_legend=rrb.PlotLegend("LeftTop"),
    )


def _percent() -> rrb.View:
    return rrb.TimeSeriesView(origin=entities.COVERAGE, name="Seen [%]", axis_y=rrb.ScalarAxis(range=(0, 105)))


def _log() -> rrb.View:
    columns = rrb.TextLogColumns(timeline_columns=["mission_time"], text_log_columns=["LogLevel", "Body"])
    return rrb.TextLogView(origin=entities.LOG, name="Log", columns=columns)
