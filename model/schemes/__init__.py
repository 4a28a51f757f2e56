"""The family of generalized-alpha schemes, its spectral radius, and classical schemes beside it."""
