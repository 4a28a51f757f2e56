"""README, pages, notebooks, examples and reports, as a reader meets them."""
