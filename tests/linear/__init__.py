"""Linear analyses: modes, stability, critical speeds, balancing, reduction."""
