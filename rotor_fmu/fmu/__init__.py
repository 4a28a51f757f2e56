"""What an FMU is: its variables, its rules, its state, and pythonfmu's skin."""
