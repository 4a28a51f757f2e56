"""FMUs as archives: equal contents give equal bytes."""

import errno
import subprocess
import sys
import zipfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from xml.etree.ElementTree import Element, fromstring, indent, tostring

from ...errors import InputError
from ...files import unfinished

DESCRIPTION = "modelDescription.xml"
ROTOR_FILE = "resources/rotor.toml"  # of a machine's FMU
_STATES = ("--handle-state", "--serialize-state")  # pythonfmu leaves them off
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)
_LEVEL = 6  # of compression: 9 takes more than twice as long for a hundredth of the size


def xml_bytes(root: Element) -> bytes:
    """Return the contents of an XML file."""
    indent(root)
    text: bytes = tostring(root, encoding="utf-8")
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + text


def wrap(script: Path, beside: Sequence[Path], raw: Path) -> None:
    """Have pythonfmu make the FMU `raw` from a script and the files beside it in the resources.

    In a process of its own: an FMU that has run in this one has left its copy of pythonfmu here,
    which makes FMUs without libraries. Raises `OSError` with pythonfmu's message if it fails.
    """
    command: list[str | Path] = [sys.executable, "-m", "pythonfmu", "build", *_STATES]
    command += ["-f", script, "-d", raw, *beside]
    done = subprocess.run(command, cwd=script.parent, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        reason = (done.stderr.splitlines() or [f"exit status {done.returncode}"])[-1]
        raise OSError(errno.EIO, f"pythonfmu cannot make an FMU of {script.name}: {reason}")


def contents_of(raw: Path) -> dict[str, bytes]:
    """Return the files that pythonfmu put into an FMU, by their paths in it, without caches."""
    with zipfile.ZipFile(raw) as source:
        return {
            name: source.read(name)
            for name in source.namelist()
            if "__pycache__" not in name and not name.endswith("/")
        }


def repack(raw: Path, target: Path, describe: Callable[[Element], Element]) -> Path:
    """Copy an FMU that pythonfmu made with its description completed by `describe`. Returns
    `target`."""
    contents = contents_of(raw)
    root = describe(fromstring(contents[DESCRIPTION].decode("utf-8")))
    return write_archive(target, contents | {DESCRIPTION: xml_bytes(root)})


def write_archive(target: Path, contents: Mapping[str, bytes]) -> Path:
    """Write files by their path in it into the FMU `target`, sorted and with one date, in a folder
    that is made if need be; returns `target`. Raises `InputError` where it would take the place of
    another model: a machine's that of a partner, or the other way round."""
    if zipfile.is_zipfile(target):
        with zipfile.ZipFile(target) as there:
            is_machine = ROTOR_FILE in there.namelist()
        if is_machine != (ROTOR_FILE in contents):
            whose = "a machine" if is_machine else "another model"
            raise InputError(f"{target}: is the FMU of {whose}; must have another name or folder")
    target.parent.mkdir(parents=True, exist_ok=True)
    with unfinished(target) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as sink:
        for name, data in sorted(contents.items()):
            info = zipfile.ZipInfo(name, _ZIP_DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            sink.writestr(info, data, compresslevel=_LEVEL)
    return target
