"""What the pages need to be followed: a way to run commands, and one finished tour of all stages for all of them."""

import contextlib
import io
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tests.docs.pages import ROOT

TOUR = "vasculo run small"
OUTSIDE = ("sweep", "match")  # they start processes of their own


class Shell:
    """Runs commands in a folder; `vasculo` in this process, which spares loading it each time."""

    def __init__(self, folder, tour=None):
        self.folder, self.tour = folder, tour

    def __call__(self, command):
        """Run a command; its exit code and all that it printed."""
        words = command.split()
        if self.tour is not None and command == TOUR and not (self.folder / "runs").exists():
            return self._copy_tour()
        plain = not set(command) & set("|&;<>$`*\"'\\")
        if words[0] == "vasculo" and words[1] not in OUTSIDE and plain:
            return self._inside(words)
        paths = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        done = subprocess.run(
            [shutil.which("bash"), "-c", command],
            cwd=self.folder,
            env={**os.environ, "PATH": paths, "COLUMNS": "120", "BROWSER": "true"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=300,
        )
        return done.returncode, done.stdout

    def _inside(self, words):
        from vasculo.cli import main

        text = io.StringIO()
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(self.folder)
            patch.setattr(sys, "argv", words)
            patch.setenv("COLUMNS", "120")
            with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
                try:
                    main()
                except SystemExit as end:
                    return end.code or 0, text.getvalue()
        return 0, text.getvalue()

    def _copy_tour(self):
        code, text, folder = self.tour
        shutil.copytree(folder / "runs", self.folder / "runs")
        return code, text


@pytest.fixture(scope="session")
def tour(tmp_path_factory):
    """`vasculo run small` done once: its exit code, what it printed, and the folder in which it ran."""
    folder = tmp_path_factory.mktemp("tour")
    code, text = Shell(folder)(TOUR)
    assert code == 0, text
    return code, text, folder


@pytest.fixture
def shell(tmp_path, tour):
    """A reader's folder: empty but for the examples of the checkout."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    return Shell(tmp_path, tour)
