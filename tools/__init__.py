"""What is run beside the tests: wrong versions, other processors, a release, the architecture."""
