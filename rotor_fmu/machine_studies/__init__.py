"""A machine as the subject of a study: its excitation, metrics, and reading both."""
