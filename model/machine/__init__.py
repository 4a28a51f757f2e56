"""Machines as data, and their files."""
