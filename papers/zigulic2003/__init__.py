"""Paper A, run again: the run-down of a three-disc rotor in two dry-friction bearings."""
