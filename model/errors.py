"""The base class of all errors about a user's input."""


class UserInputError(Exception):
    """Invalid input; the message names it, its value and what is allowed."""
