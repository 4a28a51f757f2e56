"""What the two papers ran, run again. Part of the source tree, not of the installed package."""
