"""`python -m papers.integrators`: the survey of integrators, and what a scheme does by itself."""

import typer

from rotor_fmu.errors import run

from .schemes_command import schemes
from .survey.survey_command import survey

app = typer.Typer(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)
app.command("survey")(survey)
app.command("schemes")(schemes)

if __name__ == "__main__":
    run(app)
