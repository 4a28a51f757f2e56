"""Linear analyses for users: objects for Python and notebooks, tables and pictures."""
