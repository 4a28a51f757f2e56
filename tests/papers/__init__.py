"""What repeats the papers of `papers/`."""
