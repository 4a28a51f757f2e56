"""The report of a machine: what API 617 and 684 ask for, continued into contact."""
