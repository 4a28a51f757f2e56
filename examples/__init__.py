"""Systems that the rotor is part of."""
