"""Commands that look at what was run: pictures of a run, the page of runs or of a study."""
