"""Pictures of recorded runs, and the page that shows a run or a study in a browser."""
