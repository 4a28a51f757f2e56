"""Pictures write names in letters that the usual font lacks, where an installed font has them."""

import warnings
from dataclasses import replace

import pytest
from matplotlib.font_manager import FontProperties, findfont, fontManager
from matplotlib.ft2font import FT2Font

from rotor_fmu.plotting.figure_style import entitle, new_figure, save


def letters(file):
    return {chr(code) for code in FT2Font(file).get_charmap() if code < 0x10000}


@pytest.mark.usefixtures("drawn")
def test_letters_of_another_font_are_written(tmp_path):
    """Matplotlib brings one of mathematics, which has signs beyond those of its usual one."""
    beyond = next(font for font in fontManager.ttflist if font.name == "STIXGeneral")
    known = letters(findfont(FontProperties()))
    name = "".join(sorted(c for c in letters(beyond.fname) - known if c.isprintable())[:3])
    assert len(name) == 3
    figure, axes = new_figure(4.0, 3.0)
    axes.plot([0.0, 1.0])
    entitle(figure, f"rotor {name}, 5 µm")
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a glyph that is missing
        save(figure, tmp_path / "picture.png")
        families = figure._suptitle.get_fontfamily()
        save(figure, tmp_path / "again.png")
    assert len(families) > 1
    assert figure._suptitle.get_fontfamily() == families


@pytest.mark.usefixtures("drawn")
def test_nothing_is_said_of_the_weight_of_another_font(tmp_path, monkeypatch, caplog):
    """Fonts of Chinese have no weight of 400: Matplotlib said so among a command's own lines."""
    beyond = next(font for font in fontManager.ttflist if font.name == "STIXGeneral")
    medium = replace(beyond, name="Medium", weight=500)
    monkeypatch.setattr(fontManager, "ttflist", [medium, *fontManager.ttflist])
    known = letters(findfont(FontProperties()))
    name = "".join(sorted(c for c in letters(beyond.fname) - known if c.isprintable())[3:6])
    figure, _ = new_figure(4.0, 3.0)
    entitle(figure, f"rotor {name}")
    save(figure, tmp_path / "picture.png")
    assert "Medium" in figure._suptitle.get_fontfamily()
    assert caplog.messages == []
