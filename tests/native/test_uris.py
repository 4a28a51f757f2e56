"""Where an FMU's resources lie, by the URIs and paths that hosts of each system give."""

import subprocess
from pathlib import Path

import pytest

import rotor_fmu

from ..fmu.masters import COMPILER, NEEDS_COMPILER

SOURCES = Path(rotor_fmu.__file__).parent / "fmi" / "c"
PROGRAM = """
#include "system.c"
const char *check_table(const void *table, size_t size) { (void)table, (void)size; return NULL; }
int main(int count, char **given)
{
    for (int i = 2; i < count; i++) {
        if (is_uri(given[i]))
            puts(path_in(strcpy(given[i], given[i] + 5), given[1][0] == 'w'));
        else
            puts(given[i]);
    }
    return 0;
}
"""
URIS = (
    # given, on Linux and macOS, on Windows
    ("/a/b", "/a/b", "/a/b"),
    ("file:///a/b", "/a/b", "/a/b"),
    ("FILE:///a/b", "/a/b", "/a/b"),
    ("file:/a/b", "/a/b", "/a/b"),
    ("file://localhost/a/b", "/a/b", "/a/b"),
    ("file:///C:/a", "/C:/a", "C:/a"),
    ("file:/C:/a", "/C:/a", "C:/a"),
    ("file:///C|/a", "/C|/a", "C:/a"),
    ("file://C|/a", "/a", "C:/a"),
    ("file://C:/a", "/a", "C:/a"),
    ("file://server/share/a", "/share/a", "//server/share/a"),
)


@NEEDS_COMPILER
@pytest.mark.parametrize(("system", "column"), [("posix", 1), ("windows", 2)])
def test_a_uri_is_the_path_that_its_system_means(tmp_path, system, column):
    (tmp_path / "uris.c").write_text(PROGRAM)
    command = [COMPILER, f"-I{SOURCES}", "uris.c", "-o", "uris"]
    subprocess.run(command, cwd=tmp_path, check=True)
    command = [str(tmp_path / "uris"), system, *(uri[0] for uri in URIS)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [uri[column] for uri in URIS]
