"""`python -m papers.ishikawa_koguchi`: paper B's experiments and their pictures."""
