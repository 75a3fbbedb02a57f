# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Many captures, many sensors: a row each in an SQLite database."""
import json
import os
import threading
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait

from . import _core
from ._diagnosis import _objects


class Study:
    """A study: an SQLite database with a row for each capture, made and continued by run().

    `path` is the database; sqlite3 and pandas read it as well. What a study says is worked out
    from the database at each call, so another program may write it meanwhile.
    """

    def __init__(self, path):
        self.path = os.fspath(path)

    def run(self, captures=(), *, diagnose=True, again=False, reports=None, jobs=None, progress=None):
        """Checks, calibrates and diagnoses captures (paths) that are not done or have changed since,
        those listed before as well, and gives {path: reason} of those that failed.

        diagnose=False leaves the diagnosis out. again: those too that failed or that another version
        did. reports: a folder for a page a capture. jobs: captures at a time, None: as many as
        processors. progress(fraction, path) is called after each; its exceptions, and Ctrl-C, end the
        run, and what is done stays. A capture whose analysis never
        ends or crashes takes Python with it; `iio-angle study run` gives each a process of its own.
        """
        study = _core.Study(self.path, diagnose)
        failed = {}
        try:
            study.list([os.fspath(capture) for capture in captures])
            names = study.waiting(again)
            reports = None if reports is None else os.fspath(reports)
            for done, (name, row, reason) in enumerate(_analysed(names, diagnose, reports, jobs), 1):
                study.put(row)
                if reason:
                    failed[name] = reason
                if progress:
                    progress(done / len(names), name)
        finally:
            study.close()
        return failed

    @classmethod
    def merge(cls, path, parts):
        """One Study of several (paths or Studies), in the file `path`."""
        _core.study_merge([os.fspath(getattr(part, "path", part)) for part in parts],
                          os.fspath(path))
        return cls(path)

    @property
    def json(self):
        """The report as `iio-angle study report --json` prints it, a dictionary."""
        return json.loads(_core.Study(self.path).json())

    @property
    def summary(self):
        """The same as objects: `causes`, `dependences`, `groups`, `outliers`, `sufficient_model`."""
        return _objects(self.json)

    @property
    def missing(self):
        """Shards that are missing and captures that were not done, a sentence each."""
        return _core.Study(self.path).missing().splitlines()

    def report(self, path):
        """Writes the report, one self-contained HTML page."""
        _core.Study(self.path).report(os.fspath(path))

    def __str__(self):
        return _core.Study(self.path).text()

    def __repr__(self):
        return f"<ada4571.Study: {self.path}>"


def _analysed(names, diagnose, reports, jobs):
    """(name, row, reason) of each as it is done. Few wait at a time, of however many names. Where it is
    left early, as by Ctrl-C, what runs ends as well."""
    left = threading.Event()

    def look(fraction, what):
        if left.is_set():
            raise KeyboardInterrupt

    jobs = jobs or len(os.sched_getaffinity(0))
    names = iter(names)
    with ThreadPoolExecutor(jobs) as pool:
        running = {}
        try:
            while True:
                for name in names:
                    running[pool.submit(_core.study_analyse, name, diagnose, reports, look)] = name
                    if len(running) >= 2 * jobs:
                        break
                if not running:
                    return
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    yield (running.pop(future), *future.result())
        finally:
            left.set()
            pool.shutdown(wait=False, cancel_futures=True)
