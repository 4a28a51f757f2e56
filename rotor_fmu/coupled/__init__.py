"""FMUs coupled with the rotor's: building a partner from its source, and driving one."""
