"""Periodic responses: branches, folds, stability, and the command that computes them."""
