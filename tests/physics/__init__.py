"""Contact, rest, energy, symmetries and outputs of a simulated machine."""
