"""Rotors as TOML: what is read, and one plain line for whatever is wrong."""

import math
import random
import re
from dataclasses import replace

import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.quantities import QuantityError, quantities

from ..toml_text import refusal_of

TEXT = rig_toml()
LISTED = r"[\s\S]*"  # from one [[bearing]] to the end of the file


def edited(old, new):
    """The rig's text with its first match of the pattern `old` replaced."""
    text, count = re.subn(old, lambda _: new, TEXT, count=1)
    assert count == 1
    return text


def test_the_rig_is_that_of_the_paper():
    rotor = rig()
    assert rotor.length == pytest.approx(0.33)
    assert (len(rotor.nodes), len(rotor.sections)) == (8, 7)
    assert [disc.node for disc in rotor.discs] == [4, 5, 6]
    assert [bearing.node for bearing in rotor.bearings] == [2, 8]
    for bearing in rotor.bearings:
        assert (bearing.kx, bearing.ky, bearing.mu, bearing.mass) == (5e5, 4.5e8, 0.05, 0.2)
    # a steel cylinder of 120 mm by 20 mm
    mass = rotor.discs[0].mass(rotor.material.density)
    assert mass == pytest.approx(7800 * math.pi * 0.06**2 * 0.02)
    inertia = rotor.discs[0].polar_inertia(rotor.material.density)
    assert inertia == pytest.approx(mass * 0.06**2 / 2)
    assert not rotor.rotating_damping


# (pattern in the rig's text, what replaces it, what the message must name)
WRONG = [
    (r"young = 2.1e11", "", ["material.young is missing"]),
    (r"density = 7800.0", "", ["material.density is missing"]),
    (r"nodes = .*", "", ["shaft.nodes"]),
    (r"clearance = 50e-6", "", ["bearing[1].clearance is missing"]),
    (r"width = 0.029", "", ["coupling.width is missing"]),
    (r"\[material\]\nyoung.*\ndensity.*\npoisson.*", "", ["[material] is missing"]),
    (
        r"clearance = 50e-6",
        "clearence = 50e-6",
        ["clearence: unknown key; did you mean clearance?"],
    ),
    (r"eta_v", "eta_V", ["shaft.eta_V: unknown key; did you mean eta_v?"]),
    (r"gravity", "grav", ["grav: unknown key; did you mean gravity?"]),
    (r"\[coupling\]", "[clutch]", ["clutch: unknown key", "coupling"]),
    (r"clearance = 50e-6", "clearance = nan", ["bearing[1].clearance = nan m", "must be > 0"]),
    (r"clearance = 50e-6", "clearance = -1e-5", ["bearing[1].clearance = -1e-05 m", "must be > 0"]),
    (r"clearance = 50e-6", "clearance = 0", ["bearing[1].clearance = 0 m", "must be > 0"]),
    (r"mu = 0.05", "mu = -0.05", ["bearing[1].mu = -0.05", "must be >= 0"]),
    (r"cx = 20.0", "cx = inf", ["bearing[1].cx = inf N.s/m", "finite"]),
    (r"young = 2.1e11", "young = -inf", ["material.young = -inf Pa", "finite"]),
    (r"\[material\]\nyoung = 2.1e11", "[material.a]\nyoung = 0", ["material.a.young = 0 Pa", ">"]),
    (r"e = 80e-6", "e = nan", ["disc[1].e = nan m", "finite"]),
    (r"e = 80e-6", "e = 80e-6\nphase = inf", ["disc[1].phase = inf rad", "finite"]),
    (r"gravity = 9.81", "gravity = -9.81", ["gravity = -9.81 m/s2", "must be >= 0"]),
    (r"gravity = 9.81", "gravity = 1e999", ["gravity = inf m/s2", "finite"]),
    (r"poisson = 0.3", "poisson = 0.5", ["material.poisson = 0.5", "below 0.5"]),
    (r"eta_h = 0.0", "eta_h = 0.1", ["shaft.eta_h = 0.1", "rotating_damping"]),
    (r"0.043, 0.063", "0.063, 0.063", ["shaft.element[2].length = 0 m", "must be > 0"]),
    (r"0.043, 0.063", "0.063, 0.043", ["shaft.element[2].length = -0.02 m", "must ascend"]),
    (r"0.043", "nan", ["shaft.nodes[2] = nan m", "finite"]),
    (r"0.043", '"0.043"', ["shaft.nodes[2] = '0.043'", "number"]),
    (r"0.043", "true", ["shaft.nodes[2] = True", "number"]),
    (r"0.043", "[0.043]", ["shaft.nodes[2] = [0.043]", "number"]),
    (r"nodes = .*", "nodes = 8", ["shaft.nodes = 8", "list"]),
    (r"nodes = .*", "nodes = []", ["shaft.nodes: 0 given", "2"]),
    (r", 0.330\]", "]", ["shaft.diameters: 7 given, 6 needed"]),
    (
        r"diameters = \[0.015",
        "diameters = [0.0",
        ["shaft.diameters[1] = 0 m", "must be > 0"],
    ),
    (r"node = 4", "node = 0", ["disc[1].node = 0", "from 1 to 8"]),
    (r"node = 4", "node = 99", ["disc[1].node = 99", "from 1 to 8"]),
    (r"node = 4", "node = 1.5", ["disc[1].node = 1.5", "integer"]),
    (r"node = 4", "node = true", ["disc[1].node = True", "integer"]),
    (r"node = 1\n", "node = -1\n", ["coupling.node = -1", "from 1 to 8"]),
    (r"k = 2e8", 'k = "2e8"', ["bearing[1].k = '2e8'", "number"]),
    (r"k = 2e8", "k = true", ["bearing[1].k = True", "number"]),
    (r"k = 2e8", "k = [2e8]", ["bearing[1].k = [200000000.0]", "number"]),
    (r"k = 2e8", "k = 1979-05-27", ["bearing[1].k", "number"]),
    (r"gravity = 9.81", "gravity.down = 9.81", ["gravity = {'down': 9.81}", "number"]),
    (r'name = "zigulic2003"', "name = 2003", ["name = 2003", "must be text"]),
    (r'name = "zigulic2003"', "units = 5", ["units = 5", "must be text"]),
    (
        r"rotating_damping = false",
        "rotating_damping = 0",
        ["shaft.rotating_damping = 0", "true or"],
    ),
    (r"\[\[bearing\]\]" + LISTED, "[bearing]\nnode = 2", ["bearing = {'node': 2}", "[[bearing]]"]),
    (r"\[coupling\]", "[[coupling]]", ["coupling = [", "must be a table"]),
    (r"\[material\]", "[[material]]", ["material = [", "must be a table"]),
    (r'name = "zigulic2003"', "support = [3]", ["support[1] = 3", "must be a table"]),
    (r'name = "zigulic2003"', 'support = "soft"', ["support = 'soft'", "[[support]]"]),
    (r"\[shaft\]", "[shaft]\nstart = 0.1", ["shaft.start: cannot be combined with shaft.nodes"]),
    (r"\[shaft\]", "[material]\n[shaft]", ["not valid TOML", "twice", "line"]),
    (r"gravity = 9.81", "gravity = 9.81 m/s2", ["not valid TOML", "line"]),
    (r'name = "zigulic2003"', "disc = []", ["disc = [...]", "[[disc]] cannot add", "`disc = []`"]),
    (r"gravity = 9.81", "gravity = 1" + 400 * "0", ["gravity"]),
    (r"gravity = 9.81", "gravity = " + 5000 * "1", []),
    (r"0.043", "1" + 400 * "0", ["shaft.nodes[2]"]),
    (r"gravity = 9.81", '"a\\nb" = 9.81', ["unknown key"]),
    (r"gravity = 9.81", "gravity = " + 3000 * "[" + 3000 * "]", []),
]


@pytest.mark.parametrize(
    ("old", "new", "named"), WRONG, ids=[f"{old[:20]} to {new[:20]}" for old, new, _ in WRONG]
)
def test_a_wrong_file_is_refused_in_one_line_that_names_it(old, new, named):
    message = refusal_of(edited(old, new))
    assert "\n" not in message
    for part in named:
        assert part in message


def test_a_part_with_a_misspelt_key_is_not_said_to_be_of_another_kind():
    message = refusal_of(TEXT + "[[disc]]\nnode = 2\ndiameter = 0.1\nwidhh = 0.1\n")
    assert message.startswith("disc[4].widhh: unknown key; did you mean width? known are name, ")
    assert message.endswith(", material")


HOUSING = '[[housing]]\nname = "a"\nmass = 1.0\nkx = 1.0\nky = 1.0\ncx = 0\ncy = 0'
# parts that the rig has not, each behind its own text
WRONG_PARTS = [
    ("[[housing]]\nmass = 1.0\nkx = 1.0\nky = 1.0\ncx = 0\ncy = 0", ["housing[1].name is missing"]),
    (2 * f"{HOUSING}\n", ["housing[2]: housing[1] has the name a already"]),
    (HOUSING.replace('"a"', '"bearing[2]"'), ["has the name bearing[2] already"]),
    (2 * f"{HOUSING}\n".replace('"a"', '"a\\nb"'), [r"housing[1] has the name a\nb already"]),
    ("[[section]]\nlength = 1.0", ["shaft.nodes: cannot be combined with [[section]]"]),
    ("[[port]]\nnode = 9", ["port[1].node = 9", "from 1 to 8"]),
    (
        "[[disc]]\nnode = 2\nmass = 3.0\nIp = 0.1\nId = 0.1",
        ["disc[4].mass: unknown key", "keys given are those of [[body]]"],
    ),
    (
        "[[bearing]]\nnode = 2\njournal_radius = 1e-2\nclearance = 1e-4\nk = 1e8\nmu = 0.1",
        ["bearing[3].kx is missing; the keys given are those of [[contact]]"],
    ),
    ("[[unbalance]]\nnode = 2\namount = -1e-4", ["unbalance[1].amount = -0.0001 kg.m", ">= 0"]),
    (
        '[[contact]]\nnode = 5\nhousing = "bearing[3]"\njournal_radius = 1e-2\n'
        "clearance = 1e-4\nk = 1e8\nmu = 0.1",
        ["contact[1].housing = 'bearing[3]'", "bearing[1], bearing[2]", "did you mean bearing["],
    ),
]


@pytest.mark.parametrize(("part", "named"), WRONG_PARTS)
def test_a_wrong_part_is_refused_in_one_line_that_names_it(part, named):
    message = refusal_of(f"{TEXT}\n{part}\n")
    assert "\n" not in message
    for words in named:
        assert words in message


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"sections": ()}, "shaft: no section given, at least 1 is needed"),
        ({"parts": 2 * rig().parts}, "coupling: 2 given, 1 may be"),
        ({"parts": (replace(rig().discs[0], node=True),)}, "disc[1].node = True: must be an int"),
        ({"parts": (replace(rig().discs[0], node=9),)}, "disc[1].node = 9: must be an integer fr"),
        ({"units": 5}, "units = 5: must be text"),
    ],
)
def test_a_machine_that_cannot_be_is_refused_without_a_file_too(changes, expected):
    with pytest.raises(QuantityError, match=re.escape(expected)):
        replace(rig(), **changes)


@pytest.mark.parametrize("key", ["nodes", "diameters"])
def test_a_section_needs_its_length_and_no_list_beside_it(key):
    text = "[material]\nyoung = 2e11\ndensity = 7800.0\n[[section]]\nouter = 0.03\n"
    assert refusal_of(text) == "section[1].length is missing"
    both = f"{text}length = 0.5\n[shaft]\n{key} = [0.1]\n"
    assert refusal_of(both) == f"shaft.{key}: cannot be combined with [[section]]"


def test_parts_are_replaced_where_they_stand_so_that_the_others_keep_their_order():
    still = [replace(disc, e=0.0) for disc in rig().discs]
    kinds = [type(part) for part in rig().parts]
    assert [type(part) for part in rig().with_parts(Disc, *still).parts] == kinds
    assert rig().with_parts(Disc, *still).discs == tuple(still)
    assert rig().with_parts(Support, Support(5, 1e5)).parts[:-1] == rig().parts


def test_any_number_of_parts_may_stand_at_one_node():
    rotor = parse_rotor(edited(r"node = 8", "node = 2"))
    assert [bearing.node for bearing in rotor.bearings] == [2, 2]


@pytest.mark.parametrize("kind", ["bearing", "disc"])
def test_a_rotor_may_have_none_of_a_kind(kind):
    text = re.sub(rf"(?ms)^\[\[{kind}\]\].*?(?=^\[|\Z)", "", TEXT)
    assert getattr(parse_rotor(text), f"{kind}s") == ()
    assert len(parse_rotor(text).parts) == len(rig().parts) - len(getattr(rig(), f"{kind}s"))


@pytest.mark.parametrize("text", ["", "\n\n", "# nothing"])
def test_an_empty_file_says_what_is_missing_first(text):
    assert "[material] is missing" in refusal_of(text)


JUNK = [
    "0", "-1", "1.5", "1e308", "-1e308", "nan", "-inf", "true", '""', '"x"', "[]", "[[]]", "[1, 2]",
    '["a"]', "{}", "{a = 1}", "[{}]", "07:32:00", "1979-05-27T07:32:00Z", "9223372036854775808",
]  # fmt: skip


def test_whatever_stands_behind_a_key_gives_a_rotor_or_one_plain_line():
    keys = list(re.finditer(r"(?m)^(\w+) = ([^#\n]+)", TEXT))
    rng = random.Random(0)
    refusals = []
    for match in keys:
        for junk in rng.sample(JUNK, 10):
            text = TEXT[: match.start(2)] + junk + "\n" + TEXT[match.end() :]
            try:
                parse_rotor(text)
            except QuantityError as refused:
                refusals.append((match[1], str(refused)))
    assert len(refusals) > 5 * len(keys)
    for key, message in refusals:
        assert "\n" not in message
        assert key in message or "shaft" in message


@pytest.mark.parametrize(
    "name",
    [
        "shaft.foo",
        "disc[1].foo",
        "disc[9].e",
        "disc[0].e",
        "disc[x].e",
        "wheel[1].e",
        "coupling",
    ],
)
def test_an_unknown_quantity_is_refused_by_name(name):
    with pytest.raises(QuantityError, match=re.escape(name)):
        rig().with_value(name, 1e-5)


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("disc[3].eccentricity", r"did you mean .*disc\[\d\]\.e"),
        ("bearing[1].clearence", r"did you mean bearing\[1\]\.clearance"),
        ("?", r"known: bearing\[1\]\.\w+, .* more$"),
    ],
)
def test_an_unknown_quantity_is_refused_with_what_may_be_meant(name, hint):
    with pytest.raises(QuantityError, match=f"^{re.escape(name)}: unknown quantity; {hint}"):
        rig().with_value(name, 1e-5)


def test_a_quantity_is_replaced_and_checked():
    rotor = rig().with_value("bearing[2].clearance", 6e-5).with_value("shaft.eta_v", 0.002)
    assert [b.clearance for b in rotor.bearings] == [5e-5, 6e-5]
    assert rotor.eta_v == 0.002
    with pytest.raises(QuantityError, match=re.escape("disc[2].e = -1 m: must be >= 0")):
        rig().with_value("disc[2].e", -1.0)


def test_whole_numbers_are_read_as_real_ones():
    """An integer among the quantities would have every kernel compiled again."""
    whole = re.sub(r"\b(?:k|kx|ky) = \S+", lambda m: m.group().split("=")[0] + "= 200000000", TEXT)
    whole = "gravity = 10\n" + re.sub(r"(?m)^gravity = .*$", "", whole)
    parts = [parse_rotor(whole), *parse_rotor(whole).parts]
    for part in parts:
        for name in quantities(part):
            assert isinstance(getattr(part, name), (float, str, bool)), name
    assert parts[0].gravity == 10.0
    assert {bearing.k for bearing in parts[0].bearings} == {2e8}
