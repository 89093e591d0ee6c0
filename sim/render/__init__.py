"""What a pinhole sees of a MuJoCo model: depth, segments and albedo, exact and headless."""

from sim.render.renderer import Depth, Renderer
from sim.render.view import View, looking_along

__all__ = ["Depth", "Renderer", "View", "looking_along"]
