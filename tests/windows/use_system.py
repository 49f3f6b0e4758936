# SPDX-License-Identifier: Apache-2.0
"""Run by Windows' Python: cancels a program with children, lets one end with EPG, finds the drive of a board, and ends
a host program and ``epg live`` as a user does.

The argument is the host program.  The drive has the letter U.
"""

import ctypes
import os
import queue
import subprocess
import sys
import threading
from pathlib import Path

from epg.connect.build.process import Process
from epg.generator.tools.uf2_drives import uf2_drives

SYNCHRONIZE, STILL_WAITS = 0x100000, 258
SLEEP = "import time; time.sleep(600)"  # a program that does not end by itself
PARENT = f"""if True:
    import signal, subprocess, sys
    signal.signal(signal.SIGBREAK, signal.SIG_IGN)
    child = subprocess.Popen([sys.executable, "-c", "{SLEEP}"], creationflags=0x200)  # as Ninja starts compilers
    print(child.pid, flush=True)
    child.wait()
"""
BINDER = f"""if True:
    import os, sys
    from pathlib import Path
    from epg.generator.system import here
    group = here.start([sys.executable, "-c", {SLEEP!r}], Path("."), os.environ, modest=True, bound=True)
    print(group.process.pid, flush=True)
    os._exit(0)
"""
CTRL_C, CTRL_BREAK, CLOSE = range(3)
"""Events of Windows.  CLOSE: the end of the window."""


def begin(word: str, *command: str) -> tuple[subprocess.Popen[str], str]:
    """Starts a program.  Returns it, and its first line with ``word``."""
    process = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert process.stdout is not None
    return process, next(line.strip() for line in process.stdout if word in line)


def end(event: int, process: subprocess.Popen[str]) -> tuple[int, str]:
    """Gives a program an event, as Windows does.  Returns its status, and what it said at its end.

    GenerateConsoleCtrlEvent() needs a console, and under Wine 8 it has no Ctrl-Break.
    """
    kernel, routine = ctypes.WinDLL("kernel32"), ctypes.WinDLL("kernelbase").CtrlRoutine  # type: ignore[attr-defined]
    kernel.CreateRemoteThread.argtypes = (ctypes.c_void_p,) * 7
    assert kernel.CreateRemoteThread(int(process._handle), None, None, routine, event, None, None)  # type: ignore[attr-defined]
    said = process.communicate(timeout=60)[0]
    return process.returncode, said


def runs(process: int) -> bool:
    kernel = ctypes.WinDLL("kernel32")  # type: ignore[attr-defined]
    handle = kernel.OpenProcess(SYNCHRONIZE, False, process)
    waits = bool(handle) and kernel.WaitForSingleObject(handle, 0) == STILL_WAITS
    kernel.CloseHandle(handle)
    return waits


def ends(process: int) -> bool:
    kernel = ctypes.WinDLL("kernel32")  # type: ignore[attr-defined]
    handle = kernel.OpenProcess(SYNCHRONIZE, False, process)
    waits = bool(handle) and kernel.WaitForSingleObject(handle, 20_000) == STILL_WAITS
    kernel.CloseHandle(handle)
    return not waits


said: queue.Queue[str] = queue.Queue()
process = Process((sys.executable, "-c", PARENT), Path("."), os.environ, said.put, modest=True)
thread = threading.Thread(target=process.run)
thread.start()
child = int(said.get(timeout=60))
assert runs(child)
process.cancel()
thread.join(30)
assert not thread.is_alive() and ends(child), "a child has outlived its program"
done = subprocess.run([sys.executable, "-c", BINDER], capture_output=True, text=True)
assert done.stdout.strip() and ends(int(done.stdout)), f"a program has outlived EPG: {done.stderr}"
for event in (CTRL_C, CTRL_BREAK, CLOSE):
    udp = ("--realtime", "--console-udp", "127.0.0.1:0", "--duration", "600")
    program, line = begin("udp:", sys.argv[1], *udp)
    words = (line[line.index("udp:") :], "--duration", "600", "--send", "enable", "--send", "get")
    live, _ = begin("ok get", sys.executable, "-m", "epg", "live", *words)
    shown, ended = end(event, live), end(event, program)
    assert shown[0] == 0 and "rows, 0 dropped, 0 damaged frames" in shown[1], shown
    assert ended[0] == 130 and "interrupted" in ended[1], ended
print("children end, and programs by Ctrl-C, Ctrl-Break and the end of the window;", end=" ")
print(*(f"{drive.board} is {drive.folder}" for drive in uf2_drives()))
