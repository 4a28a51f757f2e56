"""Compiled code, kept from one process to the next. It only ever saves time.

Whatever is wrong with the folder (damaged, full, missing, not this user's alone), kernels are
compiled as if there were none, and at most one sentence says so. Of several processes that need the
same code one compiles it and the others wait.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
import re
import shutil
import time
from collections.abc import Callable
from pathlib import Path

from .process_lock import ProcessLock
from .sealed_folder import SealedFolder, make_private
from .user_cache import user_cache

_KEPT_VERSIONS = 8
_VERSION_NAME = re.compile("[0-9a-f]{16}")
# For how long a process waits for the code that another one compiles [s], and how often it looks.
WAIT_AT_MOST, _WAIT = 300.0, 0.1
WAITING = "another process is compiling the solver: waiting for it"

# What no kernel of a run is made of.
_NO_KERNELS = (
    *("linear", "machine", "periodic"),
    *("rest.py", "refusal.py", "simulation.py", "code.py"),
    *(f"kernels/{name}" for name in ("code_cache", "kept_overloads", "library", "process_lock")),
    *("kernels/sealed_folder", "kernels/user_cache"),
)

_log = logging.getLogger(__name__)
_said: set[str] = set()


def _content(file: Path) -> bytes:
    return hashlib.sha256(file.read_bytes().replace(b"\r\n", b"\n")).digest()


_PACKAGE = Path(__file__).parents[1]
# By their paths. Read at once: the package's folder may be gone when the first kernel is called.
_sources = {
    file.relative_to(_PACKAGE).as_posix(): _content(file) for file in _PACKAGE.rglob("*.py")
}


def include(*files: Path) -> None:
    """Let the kept code depend on source files from outside this package too, as those of a part
    that is registered by its user. To be called before the first kernel is.

    Raises `OSError` if a file cannot be read.
    """
    _sources.update({str(file): _content(Path(file)) for file in files})


def kernels_content() -> str:
    """Sixteen characters that follow the source of all kernels of a run."""
    digest = hashlib.sha256()
    for path, content in sorted(_sources.items()):
        if not path.startswith(_NO_KERNELS):
            digest.update(path.encode() + b"\0" + content)
    return digest.hexdigest()[:16]


def own_source(function: Callable) -> bytes | None:
    """Digest of a function's source file if it lies outside this package, whose files all count
    anyway; None if there is no such file, as for one typed in."""
    file = function.__globals__.get("__file__")
    if file is None:
        return None
    try:
        return b"" if Path(file).is_relative_to(_PACKAGE) else _content(Path(file))
    except OSError:
        return None


def say_once(subject: str, sentence: str) -> None:
    """Tell the user, through Python's logging, the first sentence about a subject."""
    if subject not in _said:
        _said.add(subject)
        _log.warning(sentence)


def say_not_kept(reason: Exception | str) -> None:
    """Tell the user once that code is compiled in each process anew, and why."""
    if not isinstance(reason, (OSError, str)):
        reason = f"{type(reason).__name__}: {reason}"
    say_once("not kept", f"compiled code is not kept for the next process: {reason}")


class CodeCache:
    """The folder for code compiled from exactly these sources by `compiler`, which names Python,
    numba and the processor. The folder is chosen when it is first needed."""

    def __init__(self, compiler: str) -> None:
        self._compiler = compiler
        self._wanted: tuple[object, ...] | None = None
        self._folder: SealedFolder | None = None
        self._lock: ProcessLock | None = None
        self._is_full = False

    @property
    def path(self) -> Path | None:
        """Where code is kept, if it is."""
        folder = self._open()
        return folder.path if folder else None

    def read(self, name: str) -> bytes | None:
        """What is kept under a name; None if nothing sound is."""
        folder = self._open()
        return folder.read(name) if folder else None

    def write(self, name: str, content: bytes) -> None:
        """Keep something under a name if it can be kept."""
        folder = self._open()
        if not folder or self._is_full:
            return
        try:
            folder.write(name, content)
        except OSError as error:
            self._is_full = True
            say_not_kept(error)

    def discard(self, beginning: str) -> None:
        """Forget what is kept under names that begin so."""
        folder = self._open()
        if folder:
            for name in folder.names(beginning):
                folder.discard(name)

    def holds(self, beginning: str) -> bool:
        """Whether something sound is kept under a name that begins so."""
        folder = self._open()
        if not folder:
            return False
        return any(folder.read(name) is not None for name in folder.names(beginning))

    def wait_or_lock(self, name: str) -> bytes | None:
        """What another process that compiles now keeps under a name; None once it is on this
        process to compile, other processes being kept from it until `unlock`."""
        if not self._open() or self._lock is None or self._lock.is_held:
            return None
        end = time.monotonic() + WAIT_AT_MOST
        try:
            while not self._lock.take():
                say_once("waiting", WAITING)
                time.sleep(_WAIT)
                content = self.read(name)
                if content is not None or time.monotonic() > end:
                    return content
        except OSError:
            return None  # no locks here: each process compiles for itself
        return self.read(name)

    def unlock(self) -> None:
        """Let other processes compile."""
        if self._lock is not None:
            self._lock.release()

    def _open(self) -> SealedFolder | None:
        try:
            versions = user_cache() / "code"
            digest = hashlib.sha256(self._compiler.encode() + b"".join(sorted(_sources.values())))
            wanted = (versions, digest.hexdigest()[:16], bool(_sources))
            if wanted == self._wanted:
                return self._folder
            self.unlock()
            self._wanted, self._folder, self._lock, self._is_full = wanted, None, None, False
            if not _sources:
                raise FileNotFoundError(f"no source files in {_PACKAGE}")
            make_private(versions)
            path = versions / wanted[1]
            is_new = not path.is_dir()
            self._folder = SealedFolder(path)
            self._lock = ProcessLock(path / "lock")
            if is_new:
                _keep_newest(versions)
            else:
                with contextlib.suppress(OSError):
                    os.utime(path)  # in use: the last to be taken away
        except OSError as error:
            say_not_kept(error)
        return self._folder


def _keep_newest(versions: Path) -> None:
    with contextlib.suppress(OSError):
        folders = [path for path in versions.iterdir() if _VERSION_NAME.fullmatch(path.name)]
        folders.sort(key=lambda path: path.stat().st_mtime, reverse=True)
        for old in folders[_KEPT_VERSIONS:]:
            shutil.rmtree(old, ignore_errors=True)
