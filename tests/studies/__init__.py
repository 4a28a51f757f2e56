"""Studies: design, rows, analysis, resuming."""
