"""Depth, segments and albedo of a model, seen through a pinhole anywhere in it."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from types import TracebackType

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.errors import SimError
from sim.render.context import make_context
from sim.render.view import View
from sim.render.visibility import SHOWN, effective_rgba, showing, visible_geoms

_QUALITY = {"numslices": 48, "numstacks": 16, "numquads": 1, "offsamples": 0, "shadowsize": 0}
"""Tessellation: 48 sides leave 0.2 % of the radius between a drawn cylinder and a true one: a pixel at its rim has
the colour of what lies behind. No multisampling: depth and segments must not be blended."""
_MAX_SEGMENTS = 2**16 - 2


@dataclass(frozen=True, eq=False)
class Depth:
    """Depth and segments of a view. **The bottom row comes first**, as OpenGL has it."""

    raw: NDArray[np.float32]
    """(height, width) reversed-z depth buffer at the pixel centres: affine in inverse depth, hence linear over every
    plane; 0 where there is nothing. `Renderer.inverse_depth_scale` and `..._offset` turn it into 1/z."""
    segments: NDArray[np.uint16]
    """(height, width) index into `geom_ids`; 0 where there is nothing."""
    geom_ids: NDArray[np.int32]
    """(segments,) geom id of each segment; -1 for nothing, and for a flex or skin."""


class Renderer:
    """Owns an offscreen OpenGL context with one model in it. Use as a context manager, or close it.

    Sees what light meets (`visible_geoms`); a plane is seen from its front only, like MuJoCo's rays do. Meshes are
    two-sided. The model is left as it was found. Photographs take their colours from here; depth is a yardstick for
    tests and benchmarks.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        *,
        hidden_bodies: Collection[int] = (),
        near: float = 0.05,
        far: float = 1000.0,
    ) -> None:
        """Upload the model.

        Args:
            model: the compiled world; geoms, colours and textures are taken as they are now.
            hidden_bodies: ids of bodies never seen, such as the robot that carries the sensors.
            near: distance of the near clipping plane [m].
            far: distance of the far clipping plane, and half the size of an infinite plane [m].

        Raises:
            SimError: no OpenGL on this machine.
        """
        self.model = model
        self.hidden_bodies = hidden_bodies
        """Ids of bodies never seen."""
        self.near, self.far = near, far
        self.inverse_depth_scale = (far - near) / (far * near)
        """1/z = raw * scale + offset, z along the optical axis [m]."""
        self.inverse_depth_offset = 1.0 / far
        self._visible = visible_geoms(model, hidden_bodies)
        self._is_plane = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
        self._needs_flattening = _needs_flattening(model)
        with ExitStack() as stack, self._own_visual_settings():
            self._context = make_context()
            stack.callback(self._context.free)
            self._scene = mujoco.MjvScene(model, maxgeom=model.ngeom + model.nflex + model.nskin + 1)
            self._mjr = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50.value)
            stack.callback(self._mjr.free)
            stack.callback(self._context.make_current)
            self._owned = stack.pop_all()
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._mjr)
        self._mjr.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR
        self._option = _options()
        self._scene.flags[:] = 0  # no shadows, reflections, skybox, fog, haze; both sides of every face

    def depth(self, data: mujoco.MjData, view: View) -> Depth:
        """Render raw depth and segments in one pass.

        Args:
            data: state of the world, after `mj_kinematics` or more.
            view: the picture wanted.

        Raises:
            SimError: the scene has more geoms than segments can be told apart.
        """
        count = self.model.ngeom + self.model.nflex + self.model.nskin
        if count > _MAX_SEGMENTS:
            raise SimError(f"the scene has {count} geoms; a picture tells at most {_MAX_SEGMENTS} apart")
        geom_ids = self._compose(data, view)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
        self._scene.flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
        rect = self._render(view)
        colours = np.empty((view.height, view.width, 3), np.uint8)
        raw = np.empty((view.height, view.width), np.float32)
        mujoco.mjr_readPixels(colours, raw, rect, self._mjr)
        low_high = np.empty((view.height, view.width, 2), np.uint8)
        cv2.mixChannels([colours], [low_high], [0, 0, 1, 1])  # red is the low byte of the segment, green the high one
        return Depth(raw, low_high.view("<u2")[..., 0], geom_ids)

    def albedo(self, data: mujoco.MjData, view: View) -> NDArray[np.uint8]:
        """Render texture x rgba without any light.

        Returns:
            (height, width, 3) sRGB, bottom row first; black where there is nothing.
        """
        self._compose(data, view)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 0
        self._only_ambient_light()
        rect = self._render(view)
        colours = np.empty((view.height, view.width, 3), np.uint8)
        mujoco.mjr_readPixels(colours, None, rect, self._mjr)
        return colours

    def close(self) -> None:
        """Free the context; the renderer is of no use afterwards."""
        self._owned.close()

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, tb: TracebackType | None) -> None:
        self.close()

    def _compose(self, data: mujoco.MjData, view: View) -> NDArray[np.int32]:
        """Fill the scene with what is visible from the view, and return the geom id of every segment."""
        eye = view.world_from_view[:3, 3]
        self._point_camera(view)  # before the update: it is what infinite planes are centred on
        behind = np.einsum("gk,gk->g", eye - data.geom_xpos, data.geom_xmat[:, 2::3]) < 0
        visible = self._visible & ~(self._is_plane & behind)
        with showing(self.model, visible), self._own_visual_settings():
            categories = mujoco.mjtCatBit.mjCAT_STATIC.value | mujoco.mjtCatBit.mjCAT_DYNAMIC.value
            mujoco.mjv_updateScene(self.model, data, self._option, None, mujoco.MjvCamera(), categories, self._scene)
        self._point_camera(view)  # the update has moved the camera
        shown = np.flatnonzero(visible)
        first = self._scene.ngeom - len(shown)  # flexes and skins come before the geoms
        geoms = self._scene.geoms
        for i in np.flatnonzero(self._needs_flattening[shown]):
            geom = geoms[first + i]
            geom.rgba[3], geom.emission, geom.reflectance = 1, 0, 0
        return np.concatenate([np.full(first + 1, -1), shown]).astype(np.int32)

    def _point_camera(self, view: View) -> None:
        pose = view.world_from_view
        for camera in self._scene.camera:
            camera.pos[:] = pose[:3, 3]
            camera.forward[:] = pose[:3, 2]
            camera.up[:] = -pose[:3, 1]  # OpenCV's y is down
            camera.frustum_center = (view.left + view.right) / 2 * self.near
            camera.frustum_width = (view.right - view.left) / 2 * self.near  # half, in spite of its name
            camera.frustum_bottom, camera.frustum_top = view.bottom * self.near, view.top * self.near
            camera.frustum_near, camera.frustum_far = self.near, self.far
            camera.orthographic = 0

    def _only_ambient_light(self) -> None:
        self._scene.nlight = 1
        light = self._scene.lights[0]
        light.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL.value
        light.ambient[:], light.diffuse[:], light.specular[:] = 1, 0, 0
        light.castshadow = 0

    def _render(self, view: View) -> mujoco.MjrRect:
        self._context.make_current()
        if view.width > self._mjr.offWidth or view.height > self._mjr.offHeight:
            size = max(view.width, self._mjr.offWidth), max(view.height, self._mjr.offHeight)
            mujoco.mjr_resizeOffscreen(*size, self._mjr)
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._mjr)
        rect = mujoco.MjrRect(0, 0, view.width, view.height)
        mujoco.mjr_render(rect, self._scene, self._mjr)
        return rect

    @contextmanager
    def _own_visual_settings(self) -> Iterator[None]:
        """Lend the model our quality and our far distance, whatever the scene's author chose."""
        visual, quality = self.model.vis, self.model.vis.quality
        before = {name: getattr(quality, name) for name in _QUALITY}
        zfar, size = visual.map.zfar, (visual.global_.offwidth, visual.global_.offheight)
        try:
            for name, value in _QUALITY.items():
                setattr(quality, name, value)
            visual.map.zfar = self.far / self.model.stat.extent  # MuJoCo's unit is the extent of the model
            visual.global_.offwidth = visual.global_.offheight = 64  # grows when a view asks for it
            yield
        finally:
            for name, value in before.items():
                setattr(quality, name, value)
            visual.map.zfar = zfar
            visual.global_.offwidth, visual.global_.offheight = size


def _needs_flattening(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """(ngeom,) True for geoms that MuJoCo would blend, mirror or let glow."""
    material = model.geom_matid
    glow = np.append(model.mat_emission + model.mat_reflectance, 0)  # index -1: no material
    return (effective_rgba(model)[:, 3] < 1) | (glow[material] > 0)


def _options() -> mujoco.MjvOption:
    option = mujoco.MjvOption()
    for groups in ("sitegroup", "jointgroup", "tendongroup", "actuatorgroup"):
        getattr(option, groups)[:] = 0
    option.geomgroup[:] = 0
    option.geomgroup[SHOWN] = 1
    return option
