"""Periodic motion: harmonic balance, continuation, stability."""
