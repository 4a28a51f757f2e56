"""Oil films, for the laws of parts: pressure, load and its derivatives, tilting pads, floating
rings."""
