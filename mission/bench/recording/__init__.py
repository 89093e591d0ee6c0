"""What recordings cost: bytes, time and memory; and how fast they are read back."""
