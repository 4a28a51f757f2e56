"""`python -m papers.integrators schemes`: what integrators do to an oscillation."""
