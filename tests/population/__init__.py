"""Machines drawn at random with every kind of part, what CVODE or another integrator finds of them,
and what this project does: `python -m tests.population`."""
