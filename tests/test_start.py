"""What is loaded for an answer that must come at once."""

import json
import subprocess
import sys

HEAVY = {
    "bokeh", "cma", "dask", "distributed", "h5py", "imageio_ffmpeg", "llvmlite", "matplotlib", "numba", "numpy",
    "pandas", "PIL", "pyarrow", "pydantic", "rerun", "scipy", "shapely", "skimage",
}  # fmt: skip

TYPED = HEAVY - {"pydantic"}  # typer itself reads the arguments of a command with pydantic

COMMAND = """
import json, sys
sys.argv = ["vasculo", *sys.argv[1:]]
from vasculo.cli import main
try:
    main()
except SystemExit as end:
    code = end.code
print(json.dumps({"code": code, "loaded": sorted(name.split(".")[0] for name in sys.modules)}), file=sys.stderr)
"""

HELPS = """
import json, sys
from vasculo.cli import app
for name in sys.argv[1:]:
    app([name, "--help"], standalone_mode=False)
print(json.dumps({"loaded": sorted(name.split(".")[0] for name in sys.modules)}), file=sys.stderr)
"""


def packages(code, *words):
    """Packages that are loaded when `code` is done, by its last line on the error stream."""
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=True)
    return json.loads(done.stderr.splitlines()[-1]), done.stdout


def commands():
    _, text = packages(COMMAND, "--help")
    lines = text.split("Commands", 1)[1].splitlines()
    return [line.split()[1] for line in lines if line[:1] == "│" and line[2:3].isalpha()]


def test_the_package_loads_nothing_heavy():
    code = "import json, sys, vasculo\nprint(json.dumps([name.split('.')[0] for name in sys.modules]), file=sys.stderr)"
    loaded, _ = packages(code)
    assert "vasculo" in loaded
    assert not HEAVY & set(loaded)


def test_help_loads_nothing_heavy():
    report, text = packages(COMMAND, "--help")
    assert report["code"] in {0, None}
    assert "Commands" in text
    assert not HEAVY & set(report["loaded"])


def test_the_list_of_studies_loads_nothing_heavy():
    report, text = packages(COMMAND, "studies")
    assert report["code"] in {0, None}
    assert "paper" in text
    assert not TYPED & set(report["loaded"])


def test_help_of_every_command_loads_nothing_heavy():
    names = commands()
    assert {"run", "measure", "report"} <= set(names)
    report, text = packages(HELPS, *names)
    assert text.count("Usage:") == len(names)
    assert not TYPED & set(report["loaded"])


def test_a_name_loads_what_it_needs_and_no_pictures():
    code = (
        "import json, sys, vasculo\nvasculo.Domain\n"
        "print(json.dumps([name.split('.')[0] for name in sys.modules]), file=sys.stderr)"
    )
    loaded, _ = packages(code)
    assert "numpy" in loaded
    assert not {"matplotlib", "rerun", "dask", "pydantic"} & set(loaded)
