"""The command line: every command, every exit code, one line for whatever is wrong."""

import csv
import os
import re
import signal
import subprocess
import sys
import time

import pytest
from typer.testing import CliRunner

import vasculo
from vasculo.cli import app
from vasculo.store.table import write_whole
from vasculo.study.builtin import NAMES

COMMAND = [sys.executable, "-m", "vasculo"]
TINY = [
    "--set=domain.width=6.0",
    "--set=domain.height=4.0",
    "--set=angiogenesis.steps=1",
    "--set=output.figures=false",
]


def call(*words, **more):
    """Run in this process."""
    return CliRunner().invoke(app, [str(word) for word in words], **more)


def command(*words, **more):
    """Run in a process of its own."""
    return subprocess.run(
        [*COMMAND, *map(str, words)], capture_output=True, text=True, check=False, timeout=300, **more
    )


def one_line(result, code, *parts):
    """The exit code, nothing but one line of error, and the words in it."""
    assert result.exit_code == code, result.output
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1, result.stderr
    assert lines[0].startswith("vasculo: ")
    for part in parts:
        assert part in lines[0]


@pytest.fixture(scope="module")
def disk(tmp_path_factory):
    """The folder of a tiny finished run with pictures."""
    out = tmp_path_factory.mktemp("cli") / "disk"
    result = call("run", "disk", "--out", out, *TINY[:3])
    assert result.exit_code == 0, result.output
    return out


def test_help_names_the_commands_that_are_there():
    result = call("--help")
    assert result.exit_code == 0
    found = set(re.findall(r"^│ (\w+) ", result.output, re.MULTILINE))
    names = "run studies new check schema measure draw report view image sweep match"
    assert found == set(names.split())


def test_help_loads_nothing_heavy():
    script = (
        "import sys; sys.argv = ['vasculo', 'studies']\n"
        "from vasculo.cli import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "heavy = {'numpy', 'numba', 'scipy', 'h5py', 'matplotlib', 'shapely'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert [line.split()[0] for line in done.stdout.splitlines()] == list(NAMES)


def test_a_run_leaves_everything(disk):
    names = {path.name for path in disk.iterdir()}
    assert names == {"study.toml", "run.vtkhdf", "metrics.csv", "report.html", "figures", "checkpoint.h5", "log.txt"}
    assert len(list((disk / "figures").iterdir())) == 5
    assert vasculo.open_run(disk).facts("stages")[-1]["name"] == "pictures"


def test_a_run_prints_its_stages(tmp_path):
    result = call("run", "disk", "--out", tmp_path / "run", *TINY)
    assert result.exit_code == 0, result.output
    assert re.search(r"angiogenesis +\d+\.\d +\d+ +pillars 1 to 1, mergers 0, steps 1", result.stdout)
    assert str(tmp_path / "run" / "run.vtkhdf") in result.stdout
    assert "report.html" not in result.stdout


def test_quiet_prints_nothing(tmp_path):
    result = call("run", "disk", "--out", tmp_path / "run", "--quiet", *TINY)
    assert result.exit_code == 0
    assert result.output == ""


def test_runs_without_a_name_are_numbered(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for _ in range(2):
        assert call("run", "disk", "--quiet", *TINY).exit_code == 0
    assert sorted(path.name for path in (tmp_path / "runs").iterdir()) == ["disk", "disk-2"]
    assert call("run", "disk", "--resume", "--quiet", *TINY).exit_code == 0


def test_without_matplotlib_a_run_says_how_to_get_pictures(tmp_path):
    script = (
        "import sys; sys.modules['matplotlib'] = None\n"
        f"sys.argv = ['vasculo', 'run', 'disk', '--out', {str(tmp_path / 'run')!r}, *{TINY[:3]!r}]\n"
        "from vasculo.cli import main\nmain()"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "left out: pictures need matplotlib: pip install 'vasculo[draw]' brings it" in done.stderr
    assert vasculo.open_run(tmp_path / "run").complete
    one_line(call("draw", tmp_path / "nothing"), 2)


def test_new_gives_a_study_that_checks(tmp_path):
    file = tmp_path / "mine.toml"
    assert call("new", file).exit_code == 0
    one_line(call("new", file), 2, "exists already")
    one_line(call("new", tmp_path / "no" / "such.toml"), 2, "is no folder")
    result = call("check", file, "--set", "tissue.nodes=400")
    assert result.exit_code == 0
    for part in ("nodes", "springs", "stability limit", "expected pillars", "expected memory", "expected time"):
        assert part in result.stdout


@pytest.mark.parametrize("name", NAMES)
def test_built_in_studies_check(name):
    result = (
        call("check", name, "--set", "tissue.nodes=400")
        if name in {"paper", "plexus", "thousand", "small"}
        else call("check", name)
    )
    assert result.exit_code == 0, result.output


def test_check_refuses_an_unstable_step():
    result = call("check", "small", "--set", "tissue.nodes=400", "--set", "vasculogenesis.time_step=5.0")
    one_line(result, 2, "vasculogenesis.time_step = 5 exceeds the stability limit", "lower it")


def test_measure(disk, tmp_path):
    table = tmp_path / "table.csv"
    result = call("measure", disk, "--csv", table)
    assert result.exit_code == 0, result.output
    assert "permeability" in result.stdout
    assert "aspect ratio" in result.stdout
    assert table.read_text() == (disk / "metrics.csv").read_text()
    with table.open() as file:
        assert len(list(csv.DictReader(file))) == 2


def test_a_branch_from_a_step(disk, tmp_path):
    before = {path: path.read_bytes() for path in disk.iterdir() if path.is_file()}
    out = tmp_path / "off"
    words = ["--set", "angiogenesis.activation=0", "--set", "output.figures=false"]
    result = call("run", "--branch", disk, "--step", "0", "--out", out, *words)
    assert result.exit_code == 0, result.output
    said = f"branch of {disk} behind step 0, into {out}: angiogenesis.activation = 0.0 instead of 0.08"
    assert result.stderr.startswith(said)
    assert str(out / "run.vtkhdf") in result.stdout
    assert "branch of disk behind step 0: angiogenesis.activation = 0.0 instead of 0.08" in result.stdout
    assert "branch of disk behind step 0" in call("measure", out).stdout
    assert {path: path.read_bytes() for path in disk.iterdir() if path.is_file()} == before
    one_line(call("run", "--branch", disk, "--out", tmp_path / "no", *words), 2, "has come to its end by", "--step")
    one_line(call("run", "disk", "--branch", disk), 2, "leave the study and resume out")
    one_line(call("run", "--branch", disk, "--set", "domain.width=7"), 2, "--set: domain.width = 7.0 would change")


def test_values_on_resume(tmp_path):
    out = tmp_path / "run"
    assert call("run", "disk", "--out", out, "--quiet", *TINY).exit_code == 0
    result = call("run", "--resume", "--out", out, "--set", "angiogenesis.steps=2")
    assert result.exit_code == 0, result.output
    assert result.stderr.startswith("goes on with angiogenesis.steps = 2 instead of 1")
    assert vasculo.open_run(out).steps() == [0, 1, 2]
    more = ["--set", "angiogenesis.steps=3", "--set", "angiogenesis.response=sign"]
    result = call("run", "--resume", "--out", out, *more)
    assert result.exit_code == 0, result.output
    assert str(tmp_path / "run-branch" / "run.vtkhdf") in result.stdout
    assert vasculo.open_run(out).steps() == [0, 1, 2]
    assert vasculo.open_run(tmp_path / "run-branch").steps() == [0, 1, 2, 3]


def test_events(disk, tmp_path):
    table = tmp_path / "events.csv"
    result = call("measure", disk, "--events", table)
    assert result.exit_code == 0, result.output
    assert f"0 rows written to {table}" in result.stdout
    assert table.read_text() == "step,time,kind,x,y,angle,pillars\n"


def test_draw(disk):
    result = call("draw", disk, "--what", "flow", "--step", "1")
    assert result.exit_code == 0, result.output
    assert result.stdout.strip() == str(disk / "figures" / "flow-0001.png")
    assert len(call("draw", disk).stdout.splitlines()) == 5
    one_line(call("draw", disk, "--step", "1"), 2, "say what to draw of step 1: --what springs, mesh, flow, pressure")
    one_line(call("draw", disk, "--what", "springs"), 2, "no recorded step of vasculogenesis")


def test_draw_for_a_paper(disk):
    result = call("draw", disk, "--what", "chains", "--format", "pdf,svg", "--format", "pdf", "--width", "85mm")
    assert result.exit_code == 0, result.output
    assert result.stdout.split() == [str(disk / "figures" / f"chains-0001.{kind}") for kind in ("pdf", "svg")]
    width = re.search(r'<svg[^>]* width="([0-9.]+)pt"', (disk / "figures" / "chains-0001.svg").read_text())
    assert float(width[1]) == pytest.approx(85.0 / 25.4 * 72.0, rel=0.01)
    for words, part in [
        (
            ["--what", "folw"],
            "--what folw is not springs, mesh, flow, pressure, shear, pillars, chains or network, did you",
        ),
        (["--what", "story"], "--what story is a film: add --movie"),
        (["--what", "flow", "--format", "jpg"], "--format jpg is not png, svg or pdf"),
        (["--what", "flow", "--format", "mp4"], "mp4 and gif need --movie"),
        (["--what", "flow", "--movie", "--format", "png"], "--format png is not mp4 or gif with --movie"),
        (
            ["--what", "flow", "--width", "wide"],
            "--width wide is no width: give millimetres as 85mm or inches as 3.3in",
        ),
        (["--what", "flow", "--width", "1"], "--width 1 is 1 mm, not from 51 to 1016 mm"),
        (["--what", "flow", "--dpi", "5000"], "--dpi 5000 is not from 50 to 1200"),
        (["--what", "flow", "--fps", "5"], "--fps is for a film: add --movie"),
        (["--movie", "--width", "85mm"], "--width 85mm of a film is no number of pixels"),
        (["--movie", "--width", "20"], "width = 20 of a film is not from 160 to 3840"),
        (["--movie", "--fps", "1000"], "rate = 1000 of a film is not from 0.5 to 60"),
    ]:
        one_line(call("draw", disk, *words), 2, part)


def test_a_film(disk):
    result = call("draw", disk, "--movie", "--width", "200", "--fps", "2")
    assert result.exit_code == 0, result.output
    assert result.stdout.strip() == str(disk / "figures" / "story.mp4")
    assert (disk / "figures" / "story.mp4").read_bytes()[4:8] == b"ftyp"


def test_the_network(disk, tmp_path):
    result = call("draw", disk, "--what", "network", "--step", "1")
    assert result.exit_code == 0, result.output
    assert result.stdout.strip() == str(disk / "figures" / "network-0001.png")
    one_line(call("draw", disk, "--what", "network", "--movie"), 2, "leave --movie out")
    one_line(call("draw", disk, "--what", "network", "--step", "7"), 2, "no record of angiogenesis step 7")
    table = tmp_path / "tubules.csv"
    result = call("measure", disk, "--tubules", table)
    assert result.exit_code == 0, result.output
    with table.open() as file:
        rows = {row["other"]: row for row in csv.DictReader(file)}
    assert set(rows) == {"bottom", "left", "right", "top"}
    assert rows["left"]["flux"] == "nan"
    # the disk stands in the middle, between mirror lines: half of the flow on either side
    for column in ("flux", "network_flux"):
        assert float(rows["top"][column]) == pytest.approx(-float(rows["bottom"][column]), rel=0.02)


def test_report(disk):
    (disk / "report.html").unlink()
    result = call("report", disk)
    assert result.exit_code == 0
    assert result.stdout.strip() == str(disk / "report.html")
    assert (disk / "report.html").stat().st_size > 100_000


def bad_studies(folder):
    """Study files that cannot be used, with what is said of each."""
    files = {
        "broken.toml": ("[study\nseed = 1", "broken.toml: not TOML at line 1, column 7"),
        "unknown.toml": ("[angiogenesis]\nstep = 1", "unknown key angiogenesis.step, did you mean angiogenesis.steps?"),
        "range.toml": (
            "[angiogenesis]\nactivation = 3.0",
            "angiogenesis.activation = 3.0 is not a number from -0.6 to 0.6",
        ),
        "type.toml": ("[tissue]\nnodes = 'many'", "tissue.nodes = 'many' must be a whole number"),
        "wide.toml": ('[domain]\nkind = "voronoi"\nchannel = -1.0', "wide.toml: domain.channel must be positive"),
        "fits.toml": ('[domain]\nkind = "disk"\nradius = 5.0', "fits.toml: [domain] a disk of radius 5"),
    }
    for name, (text, _) in files.items():
        (folder / name).write_text(text)
    return {folder / name: message for name, (_, message) in files.items()}


def test_bad_studies_end_in_one_line_and_leave_nothing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for file, message in bad_studies(tmp_path).items():
        one_line(call("run", file), 2, message)
        one_line(call("check", file), 2, message)
    assert not (tmp_path / "runs").exists()


def test_other_bad_input(tmp_path, disk):
    one_line(call("run", tmp_path / "missing.toml"), 2, "no such file and no built-in study")
    one_line(call("run", "papre"), 2, "did you mean 'paper'?")
    one_line(call("run", "disk", "--set", "angiogenesis.steps"), 2, "give section.key=value")
    one_line(call("run", "disk", "--set", "angiogenesis.stepz=3"), 2, "--set: unknown key angiogenesis.stepz")
    one_line(call("run", "disk", "--out", disk), 2, "holds a run already")
    one_line(call("run", "--resume", "--out", tmp_path), 2, "holds no run to go on with")
    for name in ("measure", "draw", "report"):
        one_line(call(name, tmp_path), 2, "holds no run")
    (tmp_path / "run.vtkhdf").write_bytes(b"rubbish")
    one_line(call("measure", tmp_path), 2, "no readable record")


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["runn"], "No such command 'runn'"),
        (["run", "--oot", "x"], "No such option: --oot"),
        (["draw", "x", "--wat", "flow"], "No such option: --wat"),
        (["measure"], "Missing argument 'RUN'"),
    ],
)
def test_wrong_words_end_in_one_line(words, part):
    done = command(*words)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert part in done.stderr


def test_exit_codes_of_the_process(tmp_path):
    assert command("run", "disk", "--out", tmp_path / "run", "--quiet", *TINY).returncode == 0
    assert command("run", "disk", "--out", tmp_path / "run", *TINY).returncode == 2


def test_a_full_disk_ends_with_exit_code_1(tmp_path):
    script = (
        "import resource, sys\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000))\n"
        f"sys.argv = ['vasculo', 'run', 'disk', '--quiet', '--out', {str(tmp_path / 'run')!r}, *{TINY!r}]\n"
        "from vasculo.cli import main\nmain()"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"NUMBA_DISABLE_JIT": "0"},
    )
    assert done.returncode == 1, done.stderr
    assert len(done.stderr.splitlines()) == 1, done.stderr
    assert "run.vtkhdf cannot be written: File too large" in done.stderr
    assert not list((tmp_path / "run").glob(".*.part"))
    result = call("measure", tmp_path / "run")
    assert result.exit_code == 2 or "incomplete" in result.stdout


def test_ctrl_c_keeps_what_was_done_and_the_run_goes_on(tmp_path):
    out = tmp_path / "run"
    words = ["run", "disk", "--out", str(out), "--quiet", *TINY[:2], "--set=angiogenesis.steps=400", TINY[3]]
    process = subprocess.Popen([*COMMAND, *words], stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 240
    while time.monotonic() < deadline and process.poll() is None:
        table = out / "metrics.csv"
        if table.exists() and table.read_text().count("\n") > 3:
            break
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 130, errors
    assert len(errors.splitlines()) == 1
    assert f"go on with: vasculo run --resume --out {out}" in errors
    kept = vasculo.open_run(out)
    assert not kept.complete
    assert len(kept.steps()) >= 3
    assert kept.steps() == list(range(len(kept.steps())))


def test_files_that_cannot_be_written_are_named(tmp_path, disk):
    one_line(call("measure", disk, "--csv", tmp_path / "missing" / "table.csv"), 2, "name a file in a folder")
    one_line(call("measure", disk, "--csv", tmp_path), 2, "name a file in a folder")
    one_line(call("draw", disk, "--what", "flow", "--movie", "--step", "1"), 2, "--movie takes all steps")
    with pytest.raises(OSError, match=r"table\.csv'$") as caught:
        write_whole(tmp_path / "missing" / "table.csv", "text")
    assert ".part" not in str(caught.value)
