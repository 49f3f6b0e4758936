# SPDX-License-Identifier: Apache-2.0
"""The rules for names: C identifiers, names of ROS 2, and paths that CMake and build programs accept.

Rules for ROS names: https://design.ros2.org/articles/topic_and_service_names.html
"""

from __future__ import annotations

import re
from collections.abc import Callable

from epg.generator.correction import correction
from epg.generator.diagnostics import underscored
from epg.generator.documents.source_file import RESERVED
from epg.generator.system import here

STANDARD_HEADERS = frozenset(
    """assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic
    stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype dirent fcntl malloc
    memory poll pthread pwd sched semaphore spawn stdckdint strings syslog termios unistd values features alloca endian
    byteswap elf error link""".split()
)
"""Headers of C11, POSIX and common C libraries, without ``.h``.

The compiler would find a generated header of the same name first.
"""

SYSTEM_LIBRARIES = frozenset(
    """m c g pthread rt dl util crypt nsl resolv anl gcc gcc_s gcc_eh atomic gomp quadmath ssp asan tsan ubsan lsan
    unwind nosys rdimon gloss semihost System objc kernel32 user32 gdi32 winspool shell32 ole32 oleaut32 uuid comdlg32
    advapi32 ws2_32 winmm mingw32 mingwex moldname msvcrt""".split()
)
"""Libraries of compilers and systems.

If a CMake target has such a name, target_link_libraries(... m) links this CMake target instead of the library.
"""

STANDARD_TYPES = frozenset(
    """size_t ssize_t ptrdiff_t wchar_t wint_t max_align_t sig_atomic_t time_t clock_t clockid_t timer_t pid_t off_t
    mode_t dev_t ino_t key_t id_t uid_t gid_t nlink_t fpos_t div_t ldiv_t lldiv_t float_t double_t fenv_t fexcept_t
    errno_t rsize_t sigset_t stack_t sem_t mtx_t thrd_t cnd_t tss_t locale_t va_t intptr_t uintptr_t intmax_t uintmax_t
    useconds_t suseconds_t blksize_t blkcnt_t uint_t""".split()
) | {f"{sign}int{least}{bits}_t" for sign in ("", "u") for least in ("", "_least", "_fast") for bits in (8, 16, 32, 64)}
"""Types that are defined in headers of C11 and POSIX."""

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,62}")
_ROS_TOKEN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_NOT_IN_CMAKE = re.compile(r"\||\$[({]|\$(ENV|CACHE)\{|\]=*\]")


def identifier_problem(name: str) -> str | None:
    """The reason why ``name`` cannot be a C identifier of a user, or None."""
    if not _IDENTIFIER.fullmatch(name):
        return "is not a C identifier: use at most 63 letters, digits and '_', and do not begin with a digit"
    if name in RESERVED or name == "main":
        return "is a reserved word of C or C++"
    if name.startswith("__") or re.match("_[A-Z]", name):
        return "is reserved for the compiler: begin with a letter"
    if name.casefold().startswith("epg_") or name.casefold() == "epg":
        return (
            "begins with 'epg_', which is reserved for EPG's own symbols"
            if len(name) > 3
            else "is the prefix of EPG's own symbols"
        )
    return None


SERIAL = "$serial"
"""The placeholder for the board's serial number in the names of a node and its namespace."""
_SERIAL_NUMBER = "0123456789ABCDEF"
_NODE_SIZE, _NAMESPACE_SIZE, _TOPIC_SIZE, _PRIVATE_SIZE = 63, 63, 127, 63
"""The numbers of characters for which epg/node.h has room.

A full name of namespace, node and private topic has at most 191 characters.
"""


def node_name_problem(name: str) -> str | None:
    """The reason why ``name`` cannot be the name of a ROS 2 node, or None.

    ``$serial`` in the name becomes 16 hexadecimal digits.
    """
    if name.startswith(SERIAL):
        return f"begins with the serial number, which may begin with a digit: write 'robot_{SERIAL}'"
    name = name.replace(SERIAL, _SERIAL_NUMBER)
    if not _ROS_TOKEN.fullmatch(name):
        return "is not the name of a ROS 2 node: use letters, digits and '_', and do not begin with a digit"
    return f"is too long for a ROS 2 node: at most {_NODE_SIZE} characters" if len(name) > _NODE_SIZE else None


def namespace_problem(name: str) -> str | None:
    """The reason why ``name`` cannot be a namespace, or None.

    The leading slash is optional, and an empty text means no namespace.  ``$serial`` becomes 16 hexadecimal digits.
    """
    if name in ("", "/"):
        return None
    path = name.removeprefix("/")
    if any(token.startswith(SERIAL) for token in path.split("/")):
        return f"has a part that begins with the serial number, which may begin with a digit: write 'robot_{SERIAL}'"
    return _path_problem(path.replace(SERIAL, _SERIAL_NUMBER), "namespace", _NAMESPACE_SIZE - 1)


def normal_namespace(name: str) -> str:
    """The form of a namespace in generated code: empty, or with a leading slash."""
    path = name.strip("/")
    return f"/{path}" if path else ""


def topic_problem(name: str) -> str | None:
    """The reason why ``name`` cannot be the name of a topic, or None.  A private topic begins with ``~/``."""
    if name.startswith("~"):
        if not name.startswith("~/"):
            return "is not a topic: '~' must be followed by '/'"
        return _path_problem(name.removeprefix("~/"), "topic", _PRIVATE_SIZE)
    return _path_problem(name.removeprefix("/"), "topic", _TOPIC_SIZE)


def near_name(name: str, problem: Callable[[str], str | None]) -> str:
    """The possible name for one that ``problem`` refuses: the same words with ``_`` between them, as in ``set_x``.

    Empty if ``problem`` refuses that, too.  The slashes of topics and namespaces stay.
    """
    near = re.sub("/{2,}", "/", underscored(name, "/~$"))
    near = near if near == "/" else near.rstrip("/")
    possible = (text for text in (near, near.lstrip("/")) if text != name and problem(text) is None)
    return next(possible, "")


def name_hint(near: str, name: str) -> str:
    """The hint that proposes the name ``near`` in place of ``name``; empty if ``near`` is."""
    return correction(name, near, "write '{}'") if near else ""


def digit_hint(name: str, problem: Callable[[str], str | None]) -> str:
    """The hint for a name that ``problem`` refuses because a part of it begins with a digit; else empty.

    It is only an example, because a name such as ``2wheels`` has several possible replacements.
    """
    digits = re.compile(r"(?<![A-Za-z0-9_])(\d+)_?(\w*)", re.ASCII)
    example = digits.sub(lambda part: f"{part[2] or 'robot'}{part[1]}", name)
    possible = example != name and problem(example) is None
    return f"begin with a letter, for example '{example}'" if possible else ""


def ros_parameter_name(name: str) -> str:
    """The name of a model's parameter in ROS 2: ``Pan.PID.kp`` for ``Pan\\PID\\kp``.

    Blanks, the characters ``=<>,`` and those beyond ASCII become ``_``, as in the console.
    """
    return re.sub(r"[\s=<>,]|[^\x21-\x7e]", "_", name.replace("\\", "."))


def absolute_topic(topic: str, namespace: str, node: str) -> str:
    """The full name of ``topic``.

    An absolute name stays as it is.  A private name (``~/``) is below namespace and node, any other below the
    namespace.  ``$serial`` is replaced by a text that is as long as a real serial number.
    """
    if topic.startswith("/"):
        return topic
    below = [part for part in (namespace.strip("/"), node if topic.startswith("~/") else "") if part]
    return "/".join(["", *below, topic.removeprefix("~/")]).replace(SERIAL, _SERIAL_NUMBER)


def cmake_path_problem(path: str) -> str | None:
    """The reason why a path cannot be written in CMake's files, or in the files that CMake writes; None if it can.

    CMake does not escape ``|`` for Ninja, nor ``$(`` for Ninja and Make.  It replaces ``${X}`` in names of sources.
    In a list of CMake, a ``;`` after an open bracket does not separate elements.  ``]]`` ends a bracket argument.
    """
    if not path.isprintable():
        return "it is not printable UTF-8 text"
    found = _NOT_IN_CMAKE.search(path)
    if found:
        return f"'{found[0]}' has a special meaning in CMake or the build program"
    return "brackets in it must be balanced" if path.count("[") != path.count("]") else None


def project_folder_problem(path: str) -> str | None:
    """The reason why CMake cannot build a project in the folder ``path``, or None.

    In addition to :func:`cmake_path_problem`: CMake's own checks of a compiler fail with ``:``, ``;``, ``"`` and a
    backslash, the files that CMake writes for Make fail with ``?``, and its custom targets fail with ``#``, ``<`` and
    ``>``.
    """
    found = re.search(here.NOT_IN_PROJECTS, path)
    return f"CMake cannot build a project with '{found[0]}' in its path" if found else cmake_path_problem(path)


def _path_problem(path: str, what: str, longest: int) -> str | None:
    if not path:
        return f"is not a {what}: it is empty"
    if "__" in path:
        return f"is not a {what}: it must not contain '__'"
    for token in path.split("/"):
        if not token:
            return f"is not a {what}: it must not contain '//' or end with '/'"
        if not _ROS_TOKEN.fullmatch(token):
            return f"is not a {what}: '{token}' must have only letters, digits and '_', and must not begin with a digit"
    return f"is too long for a {what}: at most {longest} characters" if len(path) > longest else None
