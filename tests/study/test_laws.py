"""A Python file beside the study: its laws can be named, it goes along with a run, its faults are told in a line."""

import numpy as np
import pytest

import vasculo as vc
from vasculo.errors import ComputationError, InputError
from vasculo.pillars import responses
from vasculo.pillars.responses import cell_response, find_response
from vasculo.study.laws import forget_laws
from vasculo.study.run import Interrupted, run
from vasculo.study.settings import read_study

HALF = """import numpy as np
import vasculo as vc


@vc.cell_response("half")
def half(shear, mean, position):
    return 0.5 * (shear / mean - 1.0)
"""
STUDY = """[study]
uses = "my_laws.py"

[domain]
kind = "disk"
width = 6.0
height = 4.0

[angiogenesis]
steps = 3
response = "half"

[output]
figures = false
"""


@pytest.fixture(autouse=True)
def clean():
    yield
    forget_laws()


@pytest.fixture
def study(tmp_path):
    folder = tmp_path / "studies"
    folder.mkdir()
    (folder / "my_laws.py").write_text(HALF)
    (folder / "disk.toml").write_text(STUDY)
    return folder / "disk.toml"


def test_half_the_response_is_half_the_activation(study, disk_run, tmp_path):
    done = run(study, tmp_path / "run")
    assert (done.folder / "my_laws.py").read_text() == HALF
    assert done.settings["study"]["uses"] == "my_laws.py"
    assert done.settings["angiogenesis"]["response"] == "half"
    mine, whole = done.pillars(0).activation[0], disk_run.pillars(0).activation[0]
    np.testing.assert_allclose(mine, 0.5 * whole, rtol=1e-12)
    assert 0.0 < done.metrics["time"][-1] != disk_run.metrics["time"][-1]


def test_a_run_goes_on_with_its_own_copy(study, tmp_path, stop_at, same_arrays):
    whole = run(study, tmp_path / "whole")
    with pytest.raises(Interrupted):
        run(study, tmp_path / "half", progress=stop_at("angiogenesis", 1))
    (study.parent / "my_laws.py").unlink()
    same_arrays(run(out=tmp_path / "half", resume=True), whole)
    same_arrays(run(whole.folder, tmp_path / "again"), whole)
    off = run(branch=whole.folder, step=1, settings={"angiogenesis.response": "linear"}, out=tmp_path / "off")
    assert off.settings["branch"][0]["before"] == {"response": "half"}
    assert (off.folder / "my_laws.py").read_text() == HALF
    same_arrays(run(off.folder, tmp_path / "anew"), off)


def test_a_copy_that_was_changed_is_refused(study, tmp_path):
    done = run(study, tmp_path / "run")
    (done.folder / "my_laws.py").write_text(HALF.replace("0.5", "0.6"))
    with pytest.raises(InputError, match=r"my_laws\.py was changed since the run began"):
        run(out=done.folder, resume=True)


def test_a_file_named_on_the_command_line_lies_anywhere(study, disk_run, tmp_path, monkeypatch):
    monkeypatch.chdir(study.parent.parent)
    settings = {"study.uses": "studies/my_laws.py", "angiogenesis.response": "half"}
    done = run(branch=disk_run.folder, step=1, settings=settings, out=tmp_path / "new")
    assert done.settings["study"]["uses"] == "my_laws.py"
    assert (done.folder / "my_laws.py").read_text() == HALF
    assert not (disk_run.folder / "my_laws.py").exists()


def test_another_file_of_the_same_name_makes_a_branch(study, tmp_path):
    done = run(study, tmp_path / "run")
    (tmp_path / "my_laws.py").write_text(HALF.replace("0.5", "-0.5"))
    settings = {"study.uses": str(tmp_path / "my_laws.py")}
    other = run(branch=done.folder, step=1, settings=settings, out=tmp_path / "new")
    assert "-0.5" in (other.folder / "my_laws.py").read_text()
    assert "0.5" in (done.folder / "my_laws.py").read_text()
    assert other.facts("branch")[0]["changes"] == [["study.uses", "my_laws.py", "my_laws.py, another file"]]


def test_each_study_has_its_own_laws(study, tmp_path):
    read_study(study)
    read_study(study)  # again: the same name is not taken by itself
    find_response("half")
    other = tmp_path / "other_laws.py"
    other.write_text(HALF.replace("0.5", "0.25"))
    (tmp_path / "disk.toml").write_text(STUDY.replace("my_laws", "other_laws"))
    read_study(tmp_path / "disk.toml")
    assert find_response("half")(np.array([2.0]), 1.0, np.zeros(1)) == 0.25
    (tmp_path / "plain.toml").write_text("")
    read_study(tmp_path / "plain.toml")
    with pytest.raises(InputError, match="is not one of linear, logarithm, sign"):
        find_response("half")


def test_a_law_of_the_session_stays(study, monkeypatch):
    monkeypatch.setattr(responses, "_LAWS", dict(responses._LAWS))

    @cell_response("mine")
    def mine(shear, mean, _position):
        return shear - mean

    read_study(study)
    forget_laws()
    assert find_response("mine") is mine
    assert vc.Angiogenesis(response="mine").response == "mine"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\ny = (\n", r"does not run: line 2: SyntaxError: '\(' was never closed"),
        ("import numpy as np\n\nnp.nothing\n", "does not run: line 3: AttributeError: module 'numpy' has no attribute"),
        ("def f():\n    raise SystemExit(3)\n\n\nf()\n", "does not run: line 2: SystemExit: 3"),
        ("x = 1\n", r"registers nothing: write @vasculo.cell_response\(\"name\"\) above a law, or @vasculo.watcher"),
        (
            HALF.replace('"half"', '"linear"'),
            r"line 5: cell response 'linear' is already defined in .*: choose another name",
        ),
        (
            HALF.replace('"half"', '"other"'),
            r"angiogenesis.response = 'half' is not one of linear, logarithm, other, sign",
        ),
    ],
)
def test_faults_of_the_file_in_one_line(study, text, message):
    (study.parent / "my_laws.py").write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        read_study(study)
    assert str(study) in str(caught.value)
    assert "\n" not in str(caught.value)
    with pytest.raises(InputError):
        find_response("half")
    find_response("linear")


def test_a_law_that_fails_on_the_way_is_told_with_its_line(study, tmp_path):
    text = HALF.replace("return 0.5 * (shear / mean - 1.0)", "later = mean / 0\n    return shear * later")
    (study.parent / "my_laws.py").write_text(text)
    with pytest.raises(ComputationError) as caught:
        run(study, tmp_path / "run")
    message = "cell response 'half' failed: ZeroDivisionError: float division by zero (my_laws.py, line 7)"
    assert message in str(caught.value)
    assert str(caught.value).endswith(f"; what was done is kept in {tmp_path / 'run'}")


def test_faults_of_its_name(study):
    (study.parent / "my_laws.py").unlink()
    with pytest.raises(InputError, match=r"study.uses = 'my_laws.py' cannot be read in .*studies: No such file"):
        read_study(study)
    study.write_text(STUDY.replace("my_laws.py", "../my_laws.py"))
    with pytest.raises(InputError, match="is no plain name: the file lies beside the study"):
        read_study(study)
    study.write_text(STUDY.replace('"my_laws.py"', "3"))
    with pytest.raises(InputError, match=r"study.uses = 3 must be a text"):
        read_study(study)
    (study.parent / "latin.py").write_bytes(b"# \xe9\n")
    study.write_text(STUDY.replace("my_laws.py", "latin.py"))
    with pytest.raises(InputError, match="is no text file: byte 2 is not UTF-8"):
        read_study(study)
