"""A damaged or missing table of the machine in an FMU is refused. In a process of its own, which a
wrong place in memory may end."""

import shutil
from types import SimpleNamespace

import pytest

from rotor_fmu.fmi.machine_table import HEAD_SIZE

from ..processes import run_python
from .skins import SKINS, Refused

FLIPS = """
import ctypes, random, struct, sys
from rotor_fmu.fmi.machine_table import CHECKSUM_AT, HEAD_SIZE, checksum
library, table = ctypes.CDLL(sys.argv[1]), open(sys.argv[2], "rb").read()
is_mended = sys.argv[3] == "mended"
hear = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p)
said = []
listen = hear(lambda _, status, text: said.append(text))
library.rotor_instantiate.restype = ctypes.c_void_p
text = ctypes.c_char_p
library.rotor_instantiate.argtypes = text, text, ctypes.c_size_t, hear, ctypes.c_void_p
pointer, number, real = ctypes.c_void_p, ctypes.c_int, ctypes.c_double
library.fmi2SetupExperiment.argtypes = pointer, number, real, real, number, real
library.fmi2DoStep.argtypes = pointer, real, real, number
for name in ("FreeInstance", "EnterInitializationMode", "ExitInitializationMode"):
    getattr(library, f"fmi2{name}").argtypes = (pointer,)
def run(made):
    failed = library.fmi2SetupExperiment(made, 0, 0.0, 0.0, 0, 0.0) > 1
    failed = failed or library.fmi2EnterInitializationMode(made) > 1
    failed = failed or library.fmi2ExitInitializationMode(made) > 1
    return failed or library.fmi2DoStep(made, 0.0, 1e-3, 1) > 1
def instantiate(content):
    made = library.rotor_instantiate(b"a", content, len(content), listen, None)
    if made and is_mended:
        run(made)
    library.fmi2FreeInstance(made)
    return bool(made)
assert instantiate(table)
draw = random.Random(7)
_, first_write, first_need, _, _, first_block = struct.unpack_from("<6q", table, HEAD_SIZE - 48)
head = [8 * at + bit for at in range(HEAD_SIZE) for bit in range(8)]
inside = first_block if is_mended else len(table)
body = [8 * draw.randrange(HEAD_SIZE, inside) + draw.randrange(8) for _ in range(1500)]
if is_mended:  # where a parameter lies within the block the checksum alone can say
    body = [flip for flip in body if not first_write <= flip // 8 < first_need]
taken = []
for flip in head + body:
    changed = bytearray(table)
    changed[flip // 8] ^= 1 << flip % 8
    if is_mended:
        right = struct.pack("<Q", checksum(bytes(changed), CHECKSUM_AT))
        changed[CHECKSUM_AT : CHECKSUM_AT + 8] = right
    if instantiate(bytes(changed)):
        taken.append(flip)
print(len(head), len(body), len(taken), {text.partition(b": ")[2].decode() for text in said})
"""


# A number of the head that is 8 or 4096 less.
OTHER_BLOCK = """
at = int(sys.argv[4])
value, = struct.unpack_from("<q", table, at)
for less in (0, 8, 4096):
    changed = bytearray(table)
    struct.pack_into("<q", changed, at, value - less)
    struct.pack_into("<Q", changed, CHECKSUM_AT, checksum(bytes(changed), CHECKSUM_AT))
    print(instantiate(bytes(changed)))
"""


def library_and_table(extracted):
    folder = extracted["native"].folder
    name = extracted["native"].description.coSimulation.modelIdentifier
    return folder / "binaries" / "linux64" / f"{name}.so", folder / "resources" / "machine.table"


def flips(extracted, kind):
    done = run_python(FLIPS, *library_and_table(extracted), kind)
    assert done.returncode == 0, done.stderr[-1500:]
    return done.stdout


def test_a_table_with_one_bit_wrong_is_refused_wherever_it_is(extracted):
    head, body, taken, said = flips(extracted, "as it is").split(maxsplit=3)
    assert (int(head), int(body), int(taken)) == (8 * HEAD_SIZE, 1500, 0)
    assert "is damaged" in said


@pytest.mark.slow
def test_offsets_and_counts_are_checked_beside_the_checksum(extracted):
    """With a checksum that is right again a wrong place is refused, or harmless in a start and a
    step."""
    head, body, taken, said = flips(extracted, "mended").split(maxsplit=3)
    assert int(body) > 1300
    assert 0 < int(taken) < int(head) + int(body)
    assert "is damaged" in said


@pytest.mark.parametrize("of", ["first_block", "block"])
def test_a_block_that_does_not_end_the_table_is_refused(extracted, of):
    """Another place, or fewer bytes, lie within the file all the same."""
    script = FLIPS.partition("assert instantiate(table)")[0] + OTHER_BLOCK
    place = str({"first_block": HEAD_SIZE - 8, "block": 8 * 22}[of])
    done = run_python(script, *library_and_table(extracted), "as it is", place)
    assert done.returncode == 0, done.stderr[-1500:]
    assert done.stdout.split() == ["True", "False", "False"]


@pytest.mark.parametrize("kind", SKINS)
def test_a_damaged_table_says_so_to_the_host(kind, extracted, tmp_path):
    shutil.copytree(extracted[kind].folder, tmp_path / "fmu")
    table = tmp_path / "fmu" / "resources" / "machine.table"
    content = table.read_bytes()
    table.write_bytes(content[:-1000] + bytes([content[-1000] ^ 1]) + content[-999:])
    script = (
        "import sys, fmpy\n"
        "described = fmpy.read_model_description(sys.argv[1])\n"
        "for _ in range(3):\n"
        "    try:\n"
        "        fmpy.instantiate_fmu(sys.argv[1], described, 'CoSimulation')\n"
        "    except Exception as error:\n"
        "        print('refused')\n"
    )
    done = run_python(script, tmp_path / "fmu")
    assert done.stdout.split() == ["refused"] * 3, done.stderr
    assert done.stderr.count("machine.table: is damaged") == 3


@pytest.mark.parametrize("kind", SKINS)
def test_a_missing_table_is_named_to_the_host(kind, extracted, tmp_path):
    """pythonfmu's wrapper instantiates without it: then the first call is refused."""
    shutil.copytree(extracted[kind].folder, tmp_path / "fmu")
    (tmp_path / "fmu" / "resources" / "machine.table").unlink()
    script = (
        "import sys, fmpy\n"
        "described = fmpy.read_model_description(sys.argv[1])\n"
        "try:\n"
        "    fmpy.instantiate_fmu(sys.argv[1], described, 'CoSimulation').setupExperiment()\n"
        "except Exception as error:\n"
        "    print('refused')\n"
    )
    done = run_python(script, tmp_path / "fmu")
    assert done.stdout.split() == ["refused"], done.stderr
    assert "resources/machine.table: cannot be read" in done.stderr


def test_a_hash_in_what_the_slave_says_itself_reaches_the_host_as_two(extracted, tmp_path, capfd):
    """As FMI's loggers want it, and the terminal does not."""
    folder = tmp_path / "job #1"
    shutil.copytree(extracted["python"].folder, folder)
    (folder / "resources" / "machine.table").unlink()
    with pytest.raises(Refused, match=r"/job ##1/resources/machine\.table: cannot be read$"):
        SKINS["python"](SimpleNamespace(folder=folder)).setup()
    assert "/job #1/resources/machine.table: cannot be read\n" in capfd.readouterr().err
