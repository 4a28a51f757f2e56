"""The FMU without Python, the solver library and the page, on several platforms."""
