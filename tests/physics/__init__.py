"""Contact, rest, energy and outputs of a simulated machine."""
