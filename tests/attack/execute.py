# SPDX-License-Identifier: BSD-3-Clause
"""Runs the command on a case in a scratch folder, with limits of time, memory, output and written bytes. Time is that of the
processor: on a machine that does much else a run takes long, and does not hang."""

import math
import os
import resource
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass

MEMORY = 2 << 30
OUTPUT = 8 << 20
ASLEEP = 20  # times as long by the clock: a run that waits for nothing hangs too
_ticks = os.sysconf("SC_CLK_TCK")


@dataclass
class Outcome:
    code: int = 0  # negative: the signal
    out: bytes = b""
    err: bytes = b""
    hung: bool = False
    memory: int = 0  # bytes, at its peak
    changed: tuple = ()  # inputs that are no longer what they were
    written: dict = None  # output files: bytes, or None where there is none


def _resident(pid):
    try:
        with open(f"/proc/{pid}/statm", "rb") as file:
            return int(file.read().split()[1]) * resource.getpagesize()
    except (OSError, IndexError, ValueError):
        return 0


def _processor(pid):
    """Seconds, of all threads."""
    try:
        with open(f"/proc/{pid}/stat", "rb") as file:
            used = file.read().rsplit(b")", 1)[1].split()
            return (int(used[11]) + int(used[12])) / _ticks
    except (OSError, IndexError, ValueError):
        return 0


def lay_out(case, folder):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    for name in [*case.files, *case.links]:
        os.makedirs(os.path.dirname(os.path.join(folder, name)), exist_ok=True)
    for name, data in case.files.items():
        with open(os.path.join(folder, name), "wb") as file:
            file.write(data)
    for name, to in case.links.items():
        path = os.path.join(folder, name)
        os.mkfifo(path) if to is None else os.symlink(to, path) if to else os.mkdir(path)


def run(binary, case, folder, seconds):
    lay_out(case, folder)
    made = Outcome(written={})
    words = [word.encode("utf-8", "surrogateescape") for word in case.words()]
    # What a real sanitizer finds must not look like an error of ours.
    environment = {"PATH": "/usr/bin:/bin", "HOME": folder, "CLEARANCE_CACHE": "", "TBB_NUM_THREADS": "1", "ASAN_OPTIONS": "exitcode=99:detect_leaks=0",
                   "UBSAN_OPTIONS": "halt_on_error=1:exitcode=99", "LANG": "C.UTF-8"}

    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # a write beyond the limit then fails, as on a full disk
        resource.setrlimit(resource.RLIMIT_FSIZE, (case.file_limit, case.file_limit))
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds), math.ceil(seconds) + 5))

    streams = [os.path.join(folder, f".{name}") for name in ("out", "err")]
    if case.file_limit:  # the limit would hold for the streams too
        return _run_piped(binary, words, folder, environment, limit, made, case, seconds)
    with open(streams[0], "wb") as out, open(streams[1], "wb") as err:
        process = subprocess.Popen([binary, *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err, env=environment,
                                   start_new_session=True)
        _wait(process, made, seconds, streams)
    made.out, made.err = (open(name, "rb").read(OUTPUT) for name in streams)
    for name in streams:
        os.unlink(name)
    return _after(case, folder, made)


def _run_piped(binary, words, folder, environment, limit, made, case, seconds):
    process = subprocess.Popen([binary, *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               env=environment, start_new_session=True, preexec_fn=limit, restore_signals=False)
    try:
        made.out, made.err = process.communicate(timeout=ASLEEP * seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        made.out, made.err = process.communicate()
        made.hung = True
    made.code = process.returncode
    made.hung = made.hung or made.code == -signal.SIGXCPU
    return _after(case, folder, made)


def _wait(process, made, seconds, streams):
    began, pause = time.monotonic(), 0.0005
    while True:
        pid, status, used = os.wait4(process.pid, os.WNOHANG)
        if pid:
            break
        time.sleep(pause)
        pause = min(pause * 1.3, 0.02)
        made.memory = max(made.memory, _resident(process.pid))
        late = _processor(process.pid) > seconds or time.monotonic() - began > ASLEEP * seconds
        if late or made.memory > MEMORY or any(os.path.getsize(name) > 8 * OUTPUT for name in streams):
            made.hung = late
            os.killpg(process.pid, signal.SIGKILL)
            _, status, used = os.wait4(process.pid, 0)
            break
    made.memory = max(made.memory, used.ru_maxrss * 1024)
    made.code = process.returncode = os.waitstatus_to_exitcode(status)
    try:
        os.killpg(process.pid, signal.SIGKILL)  # whatever it may have started
    except ProcessLookupError:
        pass


def _after(case, folder, made):
    made.changed = tuple(name for name, data in case.files.items() if name not in case.outputs and _content(folder, name) != data)
    made.written = {name: _content(folder, name) for name in case.outputs}
    made.written.update({name: _content(folder, name) for name in os.listdir(folder) if name not in case.files})
    return made


def _content(folder, name):
    try:
        with open(os.path.join(folder, name), "rb") as file:
            return file.read()
    except OSError:
        return None
