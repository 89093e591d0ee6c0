"""Doors in coloured point clouds of rooms: the paper, section by section; a room goes in, doors come out."""
