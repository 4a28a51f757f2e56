"""The integration schemes of the solver: the generalized-alpha family, and Radau IIA."""
