"""What the Python interface refuses: one line with the argument, its value and what is allowed."""

from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from rotor_fmu.model.linear.unbalance_placement import placed_unbalances

import rotor_fmu as rf
from rotor_fmu.errors import switch
from rotor_fmu.linear.acceptance import critical_peaks

RIG = rf.load()
NAMES = np.array(["disc[2]", "pinned"])  # where one name is wanted


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({}, "stop: must be given where the speed and the loads are constant"),
        ({"stop": -1.0}, "stop = -1 s: must be > 0"),
        ({"stop": 1.0, "preset": "best"}, "preset = 'best': must be one of"),
        ({"stop": 1.0, "tolerance": 2.0}, r"^tolerance = 2\.0: must be"),
        (
            {"stop": 1.0, "parameters": {"solver.tolerance": 2.0}},
            r"^solver\.tolerance = 2\.0: must be",
        ),
        ({"stop": 1.0, "preset": NAMES}, r"^preset = array\(.*\): must be one of robust"),
        (
            {"stop": 1.0, "loads": {"disc[2].fz": 1.0}},
            r"^loads: disc\[2\].fz: unknown name; .* disc\[2\].f",
        ),
        ({"stop": 1.0, "loads": {"disc[2].fy": [1.0]}}, "must be a number, or times and values"),
        (
            {"stop": 1.0, "parameters": {"gravity": -1}},
            r"^gravity = -1: must be a finite number >= 0 m/s2",
        ),
        ({"stop": 1.0, "parameters": {"speed": 1}}, "speed is an input"),
        (
            {"stop": 1.0, "tolerance": 1e-2, "parameters": {"solver.tolerance": 1e-4}},
            r"^tolerance = 0.01: parameters give solver.tolerance too",
        ),
        ({"stop": 1.0, "loads": {"speed": 50.0}}, "loads: speed is not a load: give it as speed"),
        ({"stop": 1.0, "record": ["disc[3].z"]}, "the nearest name is"),
        ({"stop": 1.0, "per_turn": 0}, "per_turn = 0: must be > 0"),
        ({"stop": "1 s"}, "stop = '1 s': must be a number"),
        ({"stop": 1.0, "per_turn": "64"}, "per_turn = '64': must be a number"),
        ({"stop": 1.0, "step": 2.0}, "step = 2.0 s: must be > 0 and at most stop = 1 s"),
        ({"speed": ([0, 0], [1, 2])}, "speed: its times must increase"),
        ({"speed": ([0, 1], [1])}, "speed: 2 times and 1 values: must be as many"),
        ({"speed": ([0, 1], [1, np.nan])}, "speed: all of its times and values must be finite"),
        ({"stop": 1.0, "speed": np.nan}, "speed = nan: must be finite"),
        ({"stop": 1.0, "speed": "3000rpm"}, "speed = '3000rpm': must be a number, or times and"),
        ({"stop": 1.0, "speed": True}, "speed = True: must be a number"),
        ({"stop": True}, "stop = True: must be a number"),
        (
            {"stop": 1.0, "speed": (400, 0)},
            r"speed = \(400, 0\): must be a number, or times and val",
        ),
        ({"stop": 1.0, "speed": [[10**400], [1.0]]}, "speed = .*: must be a number, or times and"),
        ({"stop": 1.0, "record": [["w"]]}, r"^record: name = \['w'\]: must be text"),
        ({"stop": 1.0, "record": 3}, "^record = 3: must be a list of names"),
        ({"stop": 1.0, "loads": 3}, "^loads = 3: must be a dictionary"),
        ({"stop": 1.0, "parameters": [1, 2]}, r"^parameters = \[1, 2\]: must be a dictionary"),
        ({"stop": 1.0, "record": "disc[3].x"}, r"record = 'disc\[3\].x': must be a list of names"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(arguments, expected):
    with pytest.raises(rf.InputError, match=expected) as refused:
        rf.simulate(RIG, **{"speed": 100.0, **arguments})
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("ask", "expected"),
    [
        (
            lambda: placed_unbalances(RIG.rotor, 1.5, 100.0),
            "^mode = 1.5: must be an integer from 1 ",
        ),
        (
            lambda: placed_unbalances(RIG.rotor, "1", 100.0),
            "^mode = '1': must be an integer from 1 ",
        ),
        (lambda: critical_peaks(RIG.rotor, 300.0, 4), "^nodes = 4: must be a list of nodes"),
        (
            lambda: RIG.frequency_response([9.0], True, [1]),
            "^node = True: must be an integer from 1 ",
        ),
        (
            lambda: RIG.frequency_response([9.0], (1, 2, 3), [1]),
            r"^place = \(1, 2, 3\): must be a node",
        ),
        (lambda: RIG.frequency_response([9.0], 1, [(1, "2")]), "^offset = '2': must be a number"),
        (lambda: RIG.modes(9.0, count=True), "^count = True: must be an integer, at least 1"),
    ],
)
def test_a_node_a_mode_or_a_count_of_another_kind_is_refused_in_one_line(ask, expected):
    with pytest.raises(rf.InputError, match=expected):
        ask()


@pytest.mark.parametrize(
    ("step", "expected"),
    [("1ms", "step = '1ms': must be a number"), (0, "step = 0 s: must be > 0 and finite")],
)
def test_a_step_of_an_fmu_that_cannot_be_is_refused_by_its_name(tmp_path, step, expected):
    with pytest.raises(rf.InputError, match=f"^{expected}$"):
        rf.build_fmu(RIG, tmp_path, is_native=True, step=step)


@pytest.mark.parametrize(
    "use",
    [
        lambda it: rf.simulate(it, speed=1.0, stop=1.0),
        lambda it: rf.build_fmu(it),
        lambda it: rf.response(it, speed=(1.0, 2.0)),
    ],
)
def test_what_is_no_machine_is_refused_in_one_line(use):
    with pytest.raises(rf.InputError, match=r"^machine = 3: must be a machine"):
        use(3)


@pytest.mark.parametrize(
    ("ask", "expected"),
    [
        (lambda: RIG.unbalance_response(5.0), "speeds = 5.0: must be a list of numbers"),
        (
            lambda: RIG.unbalance_response([5.0], unbalances=[4, 1e-5]),
            r"unbalances = \[4, 1e-05\]: must be a list of \(node, amount, angle\)",
        ),
        (
            lambda: RIG.static(contacts="pinned", loads=[(4, 1.0)]),
            r"loads = \[\(4, 1.0\)\]: must be a list of \(node, force x, force y\)",
        ),
        (
            lambda: RIG.static(contacts="pinned", loads=[("4", 1.0, 0.0)]),
            "node = '4': must be an integer from 1 to 8",
        ),
        (
            lambda: rf.response(RIG, speed=(1.0, 2.0), loads={"disc[2].fy": "a"}),
            r"loads: disc\[2\].fy = 'a': must be a number",
        ),
        (lambda: RIG.modes(contacts=NAMES), "contacts = .*: must be one of open, pinned"),
        (lambda: RIG.stability(5.0, level=NAMES), "level = .*: must be 1 or 2"),
        (lambda: rf.build_fmu(RIG, fmi=NAMES), "fmi = .*: must be 2 or 3"),
        (lambda: RIG.static("fast"), "speed = 'fast': must be a number"),
        (lambda: RIG.modes(count=2.5), "count = 2.5: must be an integer, at least 1"),
        (
            lambda: RIG.campbell([0.0, 5.0], count="8"),
            "count = '8': must be an integer, at least 1",
        ),
        (lambda: RIG.stability("fast"), "speed = 'fast': must be a number"),
        (lambda: RIG.stability(5.0, anticipated="1"), "anticipated = '1': must be a number"),
        (lambda: RIG.stability(5.0, anticipated=-1.0), "anticipated = -1 N/m: must be >= 0 and .*"),
        (lambda: RIG.stability(5.0, stiffness="1"), "stiffness = '1': must be a list of numbers"),
        (lambda: RIG.stability(5.0, stiffness=[np.inf]), "stiffness: all .* must be finite"),
        (
            lambda: RIG.stability(5.0, 2, cross_couplings={3: 1e6, 4: -1e6}),
            "cross_couplings: 4 = -1e\\+06 N/m: must be >= 0 and finite",
        ),
        (lambda: RIG.stability(5.0, node="4"), "node = '4': must be an integer from 1 to 8"),
        (lambda: RIG.stability(5.0, "2"), "level = '2': must be 1 or 2"),
        (
            lambda: RIG.stability(5.0, 2, cross_couplings=[1]),
            r"cross_couplings = \[1\]: must be a dictionary",
        ),
        (
            lambda: RIG.stability(5.0, 2, cross_couplings={4: "1"}),
            "cross_couplings: 4 = '1': must be a number",
        ),
        (lambda: RIG.unbalance_check("1", 2.0, [4]), "low = '1': must be a number"),
        (lambda: RIG.unbalance_check(1.0, 2.0, 4), "probes = 4: must be a list of nodes"),
        (
            lambda: RIG.unbalance_check(1.0, 2.0, [4], clearances=[1e-4]),
            r"clearances = \[0.0001\]: must be a dictionary",
        ),
        (
            lambda: RIG.frequency_response(5.0, 4, [4]),
            "frequencies = 5.0: must be a list of numbers",
        ),
        (
            lambda: RIG.frequency_response([5.0], 4, 4),
            "nodes = 4: must be a list of nodes or places",
        ),
        (lambda: rf.response(RIG, speed=5.0, over=3), "over = 3: must be a name, FROM and TO"),
        (
            lambda: rf.response(RIG, speed=(1.0, 2.0), loads=[1]),
            r"loads = \[1\]: must be a dictionary",
        ),
        (
            lambda: rf.response(RIG, speed=(1.0, 2.0), parameters="gravity"),
            "parameters = 'gravity': must be a dictionary",
        ),
        (lambda: rf.response("a.toml", speed=(1.0, 2.0)), r"a\.toml: cannot be read: No such .*"),
        (lambda: rf.load(3), "path = 3: must be a path"),
        (lambda: rf.parse(None), "toml = None: must be the text of a machine's file"),
        (lambda: rf.read_run(None), "folder = None: must be a path"),
        (lambda: rf.simulate_fmu(None, speed=1.0), "fmu = None: must be a path"),
        (lambda: rf.simulate_fmu("a\0b", speed=1.0), r"a\\x00b: is not the FMU of a machine"),
        (lambda: rf.build_fmu(RIG, None), "folder = None: must be a path"),
        (
            lambda: rf.build_fmu(RIG, platforms="linux64"),
            "platforms = 'linux64': must be a list of .*",
        ),
        (lambda: rf.build_fmu(RIG, reduction="4"), "reduction = '4': must be a number"),
        (lambda: rf.build_fmu(RIG, reduction=None), "reduction = None: must be a number"),
        (lambda: rf.response(RIG, speed=np.array(5.0)), r"speed = 5\.0: must be FROM and TO"),
        (lambda: rf.build_fmu(RIG, parameters=3), "parameters = 3: must be a dictionary"),
        (lambda: RIG.campbell(5.0), "speeds = 5.0: must be a list of numbers"),
        (
            lambda: RIG.campbell([0.0, 5.0], harmonic=[]),
            r"harmonic = \[\]: at least one must be given",
        ),
    ],
)
def test_what_an_analysis_cannot_be_asked_is_refused_in_one_line(ask, expected):
    with pytest.raises(rf.InputError, match=f"^{expected}$"):
        ask()


@pytest.mark.parametrize(
    ("ask", "expected"),
    [
        (lambda run: run.plot(NAMES), r"kind = array\(.*\): must be one of .*"),
        (lambda run: run.plot("bode", NAMES), "place = .*: the recording has no such place.*"),
        (lambda run: run.orbit(NAMES[:1]), "place = .*: the recording has no such place.*"),
        (
            lambda run: run.plot("contact-angle", NAMES),
            "place = .*: the recording has no such contact.*",
        ),
    ],
)
def test_an_array_is_no_place_of_a_run(ask, expected):
    run = rf.simulate(RIG, speed=100.0, stop=0.1)
    with pytest.raises(rf.InputError, match=f"^{expected}$"):
        ask(run)


ANALYSES = {
    "modes": RIG.modes,
    "unbalance response": partial(RIG.unbalance_response, [5.0]),
    "unbalance check": partial(RIG.unbalance_check, 1.0, 2.0, [4]),
    "critical map": RIG.critical_map,
}


@pytest.mark.parametrize("contacts", [NAMES, ["open"], {}, "", 0, "ajar"], ids=str)
@pytest.mark.parametrize("analysis", ANALYSES)
def test_contacts_of_any_type_are_one_of_two_words(analysis, contacts):
    with pytest.raises(rf.InputError, match=r"^contacts = .*: must be one of open, pinned"):
        ANALYSES[analysis](contacts=contacts)


HUGE = 10**400  # more than a float holds


@pytest.mark.parametrize(
    ("ask", "expected"),
    [
        (lambda: RIG.modes(HUGE), r"speed = 1000+\.\.\.0+: must be a finite number"),
        (lambda: RIG.campbell([0.0, HUGE]), r"speeds = .*: must be a list of numbers"),
        (
            lambda: rf.simulate(RIG, speed=1.0, stop=HUGE),
            r"stop = 1000+\.\.\.0+: must be a finite number",
        ),
        (lambda: RIG.modes(1e300), r"speed = 1e\+300 rad/s: must not exceed 1e\+30 in size"),
        (
            lambda: RIG.unbalance_check(1.0, 1e300, [4]),
            r"high = 1e\+300 rad/s: must not exceed 1e\+30 in size",
        ),
    ],
)
def test_a_number_beyond_all_calculation_is_refused_in_one_line(ask, expected):
    with pytest.raises(rf.InputError, match=f"^{expected}$"):
        ask()


def test_a_speed_may_be_a_fraction():
    assert RIG.modes(Fraction(1, 2)).eigenvalues[0] == RIG.modes(0.5).eigenvalues[0]
    receptance = [RIG.frequency_response([9.0], 4, [4], speed=of) for of in (Fraction(1, 2), 0.5)]
    assert receptance[0].receptance.tolist() == receptance[1].receptance.tolist()


@pytest.mark.parametrize(
    "ask",
    [
        partial(rf.build_fmu, RIG, "nowhere", is_free="no"),
        partial(rf.build_fmu, RIG, "nowhere", is_native=1),
        partial(rf.build_fmu, RIG, "nowhere", is_source=[]),
        partial(rf.simulate, RIG, speed=1.0, stop=1.0, verify="no"),
        partial(rf.response, RIG, speed=(1.0, 2.0), stability=None),
        partial(rf.response, RIG, speed=(1.0, 2.0), whirl="no"),
        partial(rf.response, RIG, speed=(1.0, 2.0), branches=NAMES),
        partial(RIG.critical_map, synchronous="no"),
        partial(RIG.critical_map, rigid_pedestals=NAMES),
    ],
    ids=lambda ask: [*ask.keywords][-1],
)
def test_what_is_true_or_false_is_nothing_that_only_counts_as_it(ask):
    with pytest.raises(rf.InputError, match=f"^{[*ask.keywords][-1]} = .*: must be True or False$"):
        ask()


def test_true_may_be_one_of_numpy():
    assert switch("is_free", np.True_) is True
    assert switch("is_free", np.array(False)) is False


def test_a_critical_map_has_no_more_lines_than_the_machine_has_motions():
    few, many = (RIG.critical_map([1e6, 1e7], count=of).speeds for of in (2, HUGE))
    assert many[:, :2].tolist() == few.tolist()
    assert many.shape[1] < 1000


@pytest.mark.parametrize(
    ("folder", "expected"),
    [
        ("a\0b", "cannot be written to: has a NUL in its name"),
        (__file__, "cannot be written to: File exists"),
        ("rig.fmu", "is a folder for files, and is called like one of them"),
    ],
)
def test_a_folder_that_none_can_be_is_refused_in_one_line(folder, expected):
    run = rf.simulate(RIG, speed=100.0, stop=0.1)
    for write in (run.save, partial(rf.build_fmu, RIG)):
        with pytest.raises(rf.InputError, match=f"^folder = .*: {expected}$"):
            write(folder)


def test_a_cross_coupling_may_be_an_array_of_no_dimension():
    one, other = (
        RIG.stability(5.0, anticipated=of, contacts="pinned") for of in (1e3, np.array(1e3))
    )
    assert other.anticipated == one.anticipated
    assert other.log_dec_anticipated == one.log_dec_anticipated


def test_files_that_are_none_are_refused_by_their_name(tmp_path):
    path = tmp_path / "machine.toml"
    path.write_text("nonsense")
    for read in (rf.load, rf.read_run, lambda p: rf.simulate_fmu(p, speed=1.0, stop=1.0)):
        with pytest.raises(rf.InputError, match=r"machine\.toml"):
            read(path)
