"""What every error about a user's input is."""


class UserInputError(Exception):
    """Something given that cannot be; the message names it, its value and what is allowed."""
