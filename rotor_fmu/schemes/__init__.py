"""`rotor-fmu schemes`: what integrators do to an oscillation."""
