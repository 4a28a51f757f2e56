"""Linear answers for a person: `answers` for Python and notebooks, `command` for the shell."""
