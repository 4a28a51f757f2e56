"""Pictures of machines and of recorded signals, and the common style of all pictures."""
