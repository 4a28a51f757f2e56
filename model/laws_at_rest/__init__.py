"""Laws at rest, by the solver library: forces and tangents, where a journal rests in its film, and
how warm its oil is there."""
