"""What a pinhole sees of a MuJoCo model: depth, segments and albedo, exact and headless."""

from sim.render.renderer import Depth, Renderer, View

__all__ = ["Depth", "Renderer", "View"]
