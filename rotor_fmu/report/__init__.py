"""The page that shows a run or a study in a browser."""
