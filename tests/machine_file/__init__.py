"""Machine files: keys, names, places, plausibility."""
