"""The command line: its commands, options, messages and exit statuses."""
