"""The program `rotor-fmu` from its first moment: while the command line is imported, Ctrl-C ends it
as it does later, in one line."""


def main() -> None:
    """Entry point of the command `rotor-fmu`."""
    try:
        from .cli import main as command_line
    except KeyboardInterrupt:
        from .errors import end_stopped

        end_stopped()
    command_line()
