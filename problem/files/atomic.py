"""Files: read only if they are regular ones; written complete or not at all.

Whatever is written is first a draft beside its target, ``.trajgap-TARGET-RANDOM.tmp``: TARGET is a
hash of the target's name, RANDOM cannot be guessed. The process that writes it holds a lock on it.
So a draft without a lock was left by a process that was killed, and the next one that writes the
same target removes it; a draft with a lock says that somebody is writing that target now.

An old folder steps aside for its draft, as ``.trajgap-TARGET-RANDOM.old``; when a process is killed
just then, the next one that asks for the folder moves it back (`recover_folder`).
"""

from __future__ import annotations

import errno
import os
import shutil
import stat
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from uuid import uuid4

from ..errors import CaseError

_PREFIX = ".trajgap-"
"""Start of the name of every draft; hidden, and told apart from files of others."""
_NOT_OFFERED = (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP, errno.EPERM)
"""What systems and file systems answer that cannot make hard links."""

_drafts: set[Path] = set()
"""Drafts of this process, for `remove_drafts`."""
_stepping: set[Path] = set()
"""Folders of this process that step aside just now, for `remove_drafts`."""


# --- reading --------------------------------------------------------------------------------------


def read_regular(path: Path, largest: int, fix: str) -> bytes:
    """Read a regular file of bounded size; never wait for another kind of file.

    Parameters
    ----------
    largest : int
        Bytes.
    fix : str
        What to do if it is larger, for the message.

    Raises
    ------
    CaseError
        If the file is missing, not a regular file, too large or unreadable, or if its name is not
        UTF-8.
    """
    name = str(path)
    check_name(name)
    try:
        # Asked before opening: to open a device or a pipe can change or block something.
        _check_regular(name, path.stat())
        with open(path, "rb", opener=_without_waiting) as file:
            status = os.fstat(file.fileno())
            _check_regular(name, status)
            # One byte more than allowed: the file may grow while it is read.
            data = file.read(largest + 1)
            size = max(status.st_size, len(data))
    except (FileNotFoundError, NotADirectoryError):
        raise CaseError(name, "", "no such file; check the path") from None
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise CaseError(name, "", f"cannot be read ({reason}); check the path") from None
    if size > largest:
        raise CaseError(
            name, "", f"has {size / 1e6:.1f} MB, the limit is {largest / 1e6:.0f} MB; {fix}"
        )
    return data


def check_regular(path: Path) -> None:
    """Refuse what is no regular file, because reading it might never end."""
    check_name(str(path))
    with suppress(OSError):
        _check_regular(str(path), path.stat())


def check_name(name: str) -> None:
    """Refuse the name of a file that is not UTF-8: no document could state it."""
    try:
        name.encode("utf-8")
    except UnicodeEncodeError:
        raise CaseError(name, "", "is not UTF-8; rename the file") from None
    if "\0" in name:
        raise CaseError(name, "", "no such file; check the path")


def _check_regular(name: str, status: os.stat_result) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise CaseError(name, "", "is a directory; give a file in it")
    if not stat.S_ISREG(status.st_mode):
        raise CaseError(name, "", "is not a regular file; name a text file")


def _without_waiting(path: str, flags: int) -> int:
    # What was a regular file a moment ago may be a pipe now.
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


# --- writing --------------------------------------------------------------------------------------


@contextmanager
def new_file(path: Path) -> Iterator[Callable[[str | bytes], None]]:
    """Reserve a new file, which appears under its name only when complete.

    Yields
    ------
    callable
        To be called with the whole content, once.

    Raises
    ------
    OSError
        If the file exists, is being written by another process, or cannot be written.
    """
    with _draft(path, reserve=True) as draft:

        def write(content: str | bytes) -> None:
            if isinstance(content, bytes):
                draft.write_bytes(content)
            else:
                draft.write_text(content, encoding="utf-8", newline="\n")
            _publish(draft, path)

        yield write


@contextmanager
def new_draft(path: Path, is_folder: bool = False) -> Iterator[Path]:
    """Reserve a new file or folder for a writer that needs a path.

    Yields
    ------
    Path
        An empty file or folder; what is in it at the end appears under the name, at once.

    Raises
    ------
    OSError
        As `new_file`.
    """
    with _draft(path, is_folder, reserve=True) as draft:
        yield draft
        if is_folder:
            draft.rename(path)
        else:
            _publish(draft, path)


def replace_file(path: Path, text: str) -> None:
    """Write a complete file in a single step, replacing an earlier one.

    Parameters
    ----------
    path : Path
        Missing parent folders are created.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with _draft(path) as draft:
        draft.write_text(text, encoding="utf-8", newline="\n")
        draft.replace(path)


def replace_folder(folder: Path, files: Mapping[str, str]) -> None:
    """Write a complete folder in a single step, replacing an earlier one.

    However the process ends, the earlier folder or the new one is there, or `recover_folder`
    brings the earlier one back.

    Parameters
    ----------
    folder : Path
        Missing parent folders are created.
    files : mapping
        Path inside the folder, with slashes, to text.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    recover_folder(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with _draft(folder, is_folder=True) as draft:
        for name, content in files.items():
            file = draft / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(content, encoding="utf-8", newline="\n")
        _step_aside(draft, folder)


def recover_folder(folder: Path) -> None:
    """Restore a folder that was renamed for its successor when the process was killed.

    Parameters
    ----------
    folder : Path
        Left alone if it exists; remains of it are removed then.

    Raises
    ------
    OSError
        If the names of files there cannot be changed.
    """
    aside = [path for path in _left_behind(folder) if path.suffix == ".old"]
    if aside and not _there(folder):
        newest = max(aside, key=lambda path: path.stat().st_mtime)
        newest.rename(folder)
        aside.remove(newest)
    for path in aside:
        _remove(path)


def try_writing_in(folder: Path) -> None:
    """Check whether files can be written into a folder, which need not exist yet.

    Raises
    ------
    OSError
        If it cannot be made, or nothing can be written into it.
    """
    missing: list[Path] = []
    for there in (folder, *folder.absolute().parents):
        if _there(there):
            break
        missing.append(there)
    for one in missing:
        # Says whether the name is too long, which a path through missing folders does not.
        _there(there / one.name)
    if not there.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(there))
    trial = there / f"{_PREFIX}{uuid4().hex}.tmp"
    with _registered(trial):
        trial.mkdir()


def remove_drafts() -> None:
    """Remove every draft of this process, which may be about to end at any moment."""
    for folder in list(_stepping):
        with suppress(OSError):
            recover_folder(folder)
    for path in list(_drafts):
        _remove(path)


@contextmanager
def _draft(target: Path, is_folder: bool = False, reserve: bool = False) -> Iterator[Path]:
    """Make a locked draft beside its target, removed in the end; remains of others are swept."""
    if reserve and _there(target):
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(target))
    while True:
        path = target.parent / f"{_stem(target)}{uuid4().hex}.tmp"
        with _registered(path):
            if is_folder:
                path.mkdir()
            else:
                # Not `tempfile`: what it makes is for the user alone, and so would the file be.
                os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
            with _locked(path):
                if not path.exists():
                    # Another process took it for a remain before the lock was on it.
                    continue
                busy = _sweep(target, path)
                if busy and reserve:
                    raise BlockingIOError(errno.EBUSY, "another process writes it")
                yield path
                return


@contextmanager
def _registered(path: Path) -> Iterator[None]:
    # Before it is made: an interrupt may come between any two lines.
    _drafts.add(path)
    try:
        yield
    finally:
        _remove(path)
        _drafts.discard(path)


def _stem(target: Path) -> str:
    return f"{_PREFIX}{sha256(os.fsencode(target.name)).hexdigest()[:16]}-"


def _left_behind(target: Path) -> list[Path]:
    """Drafts of a target, and folders that stepped aside for it."""
    stem = _stem(target)
    try:
        return sorted(path for path in target.parent.iterdir() if path.name.startswith(stem))
    except OSError:
        return []


def _sweep(target: Path, own: Path) -> bool:
    """Remove drafts that killed processes left; whether another process is writing the target."""
    busy = False
    for path in _left_behind(target):
        if path != own and path.suffix == ".tmp":
            with suppress(OSError), _locked(path) as free:
                if free:
                    _remove(path)
                busy |= free is False
    return busy


@contextmanager
def _locked(path: Path) -> Iterator[bool | None]:
    """Lock a file or folder; yields whether nobody else had, None where locks are not offered."""
    if sys.platform == "win32":
        yield None
        return
    import fcntl

    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW)
    try:
        free: bool | None = True
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            free = False
        except OSError:
            free = None
        yield free
    finally:
        os.close(descriptor)


def _publish(draft: Path, path: Path) -> None:
    """Give a draft its name, never over another file."""
    try:
        os.link(draft, path)
    except OSError as error:
        if error.errno not in _NOT_OFFERED:
            raise
        if _there(path):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path)) from None
        draft.rename(path)


def _step_aside(draft: Path, folder: Path) -> None:
    """Put a draft in the place of a folder by two renames; `recover_folder` covers the gap."""
    old = folder.parent / f"{_stem(folder)}{uuid4().hex}.old"
    _stepping.add(folder)
    try:
        if _there(folder):
            folder.rename(old)
        draft.rename(folder)
    finally:
        recover_folder(folder)
        _stepping.discard(folder)


def _there(path: Path) -> bool:
    """Whether anything has this name, a broken link included; other faults than absence show."""
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()
