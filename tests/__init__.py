"""Tests: laws of physics, closed forms and other programs' numbers first."""
