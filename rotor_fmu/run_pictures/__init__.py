"""Pictures of runs: the kinds of `rotor-fmu plot`, and what a run leaves in its folder."""
