"""One file a part of a machine."""
