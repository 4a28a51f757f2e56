"""Pictures of machines, and the common style of all pictures."""
