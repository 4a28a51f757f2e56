"""Balancing of a machine by runs in time, and its result."""
