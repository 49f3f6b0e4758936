# SPDX-License-Identifier: Apache-2.0
"""Run by Windows' Python: cancels a program with children, lets one end with EPG, and finds the drive of a board.

The argument is the folder of the drive of a board, which has the letter U.
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
print("children end;", *(f"{drive.board} is {drive.folder}" for drive in uf2_drives()))
