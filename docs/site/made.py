"""Write the pages and the figure that are made from the code: `make pages`."""

import runpy
from pathlib import Path

from rotor_fmu.model.machine.toml import rig

from papers.integrators.survey.findings import Findings
from papers.integrators.survey.grid import read_table
from papers.integrators.survey.page import PAGE, page_text
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.packing.documents import markdown
from rotor_fmu.machine_file.reference_page import page as machine_page
from tools.architecture import PICTURE, picture

DOCS = Path(__file__).parents[1]


def made() -> dict[Path, str]:
    """Return the text of each generated file as the code makes it now."""
    beside = Path(__file__).parent
    commands, results = (runpy.run_path(str(beside / f"{n}.py")) for n in ("commands", "results"))
    variables = DOCS / "reference" / "variables.md"
    head, bar, _ = variables.read_text(encoding="utf-8").partition("| variable |")
    if not bar:
        raise ValueError(f"{variables}: has no table")
    return {
        DOCS / "reference" / "commands.md": commands["page"](),
        DOCS / "reference" / "machine.md": machine_page() + "\n",
        DOCS / "reference" / "results.md": results["page"](),
        variables: head + markdown(interface(rig())),
        DOCS / PAGE: page_text(Findings(read_table(DOCS / "data" / "integrators.csv.gz"))),
        PICTURE: picture(),
    }


if __name__ == "__main__":
    for path, text in made().items():
        path.write_text(text, encoding="utf-8")
        print(path)
