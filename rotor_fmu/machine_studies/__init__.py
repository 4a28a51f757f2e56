"""A machine as the subject of a study: its excitation, the metrics of each run, and reading
both."""
