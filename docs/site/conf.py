"""Sphinx' configuration of the site: Markdown, in a theme that loads nothing from a network."""

from rotor_fmu.about import __version__

project = "rotor-fmu"
author = "the rotor-fmu authors"
version = release = __version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.viewcode", "sphinx_copybutton"]
myst_enable_extensions = ["dollarmath"]
nb_execution_mode = "off"  # the tests run the notebooks
myst_heading_anchors = 3
html_theme = "furo"
html_title = "rotor-fmu"
html_show_sphinx = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
