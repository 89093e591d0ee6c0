"""How fast we are, beside the renderer alone and beside what else a user could pick."""
