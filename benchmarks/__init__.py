"""What a run costs and how far it is from the truth, beside other programs."""
