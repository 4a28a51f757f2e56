"""A machine as what a study runs: how it is driven, what is kept, and reading both."""
