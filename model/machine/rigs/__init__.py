"""Rotors as data."""
