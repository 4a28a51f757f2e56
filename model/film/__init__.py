"""Oil films: pressure, load and its derivatives, tilting pads, floating rings."""
