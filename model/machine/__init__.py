"""What a machine is, as data."""
