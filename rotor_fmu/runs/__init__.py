"""Runs through a built FMU: signals, run-down, reproduction, reports."""
