"""Results against other programs, and the verification that the project carries."""
