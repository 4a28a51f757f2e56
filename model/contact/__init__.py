"""Contact of a journal with a wall, for the laws of parts: geometry, normal force, friction."""
