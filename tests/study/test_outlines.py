"""A domain in a file beside a study: it comes back, goes along with its run, and is refused in one line."""

import json

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.plexus.voronoi import disk_domain, voronoi_plexus
from vasculo.store.read import open_run
from vasculo.study.outlines import outlines_domain, outlines_text, take_along
from vasculo.study.run import run
from vasculo.study.settings import read_study

STUDY = '[domain]\nkind = "outlines"\nfile = "here.json"\n[angiogenesis]\nsteps = 1\n[output]\nfigures = false\n'


@pytest.fixture
def study(tmp_path):
    """A study of one disk, with its outlines beside it."""
    (tmp_path / "here.json").write_text(outlines_text(disk_domain(6.0, 4.0)))
    (tmp_path / "mine.toml").write_text(STUDY)
    return tmp_path / "mine.toml"


def test_outlines_come_back(tmp_path):
    domain = voronoi_plexus(6, seed=1)
    (tmp_path / "x.json").write_text(outlines_text(domain))
    found = outlines_domain("x.json", tmp_path)
    assert found.sides == domain.sides
    assert np.allclose(found.outer, domain.outer, rtol=1e-9)
    for one, two in zip(found.pillars, domain.pillars, strict=True):
        assert np.allclose(one, two, rtol=1e-9, atol=1e-9)


def test_a_study_reads_the_file_beside_it(study, monkeypatch):
    monkeypatch.chdir(study.parent.parent)
    settings = read_study(study)
    assert settings.kind == "outlines"
    assert settings.domain == {"file": "here.json"}
    assert settings.stages == ("domain", "angiogenesis")
    assert 'file = "here.json"' in settings.to_toml()


def test_the_outlines_go_along_with_a_run(study, tmp_path):
    first = run(study, tmp_path / "one")
    again = run(tmp_path / "one" / "study.toml", tmp_path / "two")
    assert np.array_equal(*(np.concatenate(each.pillars().outlines) for each in (first, again)))
    study.unlink()
    (tmp_path / "here.json").unlink()
    resumed = run(None, tmp_path / "one", resume=True)
    assert resumed.complete
    assert open_run(tmp_path / "two").settings["domain"] == {"kind": "outlines", "file": "here.json"}


def test_another_file_is_not_replaced(study, tmp_path):
    target = tmp_path / "runs"
    target.mkdir()
    (target / "here.json").write_text("something else")
    with pytest.raises(InputError, match=r"runs holds another here\.json that the run would replace: name another"):
        run(study, target)
    assert (target / "here.json").read_text() == "something else"
    (target / "here.json").write_bytes((tmp_path / "here.json").read_bytes())
    assert take_along("here.json", tmp_path, target) is None


def test_a_run_that_cannot_begin_leaves_nothing(study, tmp_path):
    far = {"outer": [[0, 0], [9, 0], [9, 9], [0, 9]], "sides": ["bottom", "right", "top", "left"]}
    far["pillars"] = [[[1, 1], [4, 1], [4, 4], [1, 4]], [[4 + 1e-8, 1], [8, 1], [8, 4], [4 + 1e-8, 4]]]
    (tmp_path / "here.json").write_text(json.dumps(far))
    with pytest.raises(InputError, match="apart"):
        run(study, tmp_path / "out")
    assert not (tmp_path / "out").exists()


BOX = '{"outer": [[0, 0], [9, 0], [9, 9], [0, 9]], "sides": ["bottom", "right", "top", "left"], "pillars": '
WRONG = [
    ("[1, 2", "is no JSON: Expecting ',' delimiter"),
    ("[1, 2]", "must hold outer, sides, pillars, and nothing else"),
    ('{"outer": []}', "must hold outer, sides, pillars"),
    (BOX + "[[[1, 1], [2, 1]]]}", ": pillar 0: "),
    (BOX + "[[[1, 1], [20, 1], [2, 2]]]}", ": pillar 0 is not strictly inside the outer outline"),
    (BOX + '[["a"]]}', ": "),
    (BOX + "[]}", "needs sides 'left' and 'right' and at least one pillar"),
    (BOX.replace("right", "east") + "[[[1, 1], [2, 1], [2, 2]]]}", "needs sides 'left' and 'right'"),
    (BOX.replace('["bottom", "right", "top", "left"]', "3") + "[[[1, 1], [2, 1], [2, 2]]]}", "sides a list of names"),
]


@pytest.mark.parametrize(("content", "message"), WRONG)
def test_files_that_are_no_outlines(study, content, message):
    (study.parent / "here.json").write_text(content)
    with pytest.raises(InputError) as caught:
        read_study(study)
    text = str(caught.value)
    assert text.startswith(f"{study}: domain.file = 'here.json'")
    assert message in text
    assert "\n" not in text


def test_files_that_are_not_there(study, tmp_path):
    with pytest.raises(InputError, match=r"domain\.file = 'no\.json' cannot be read in .*: No such file"):
        read_study(study, {"domain.file": "no.json"})
    with pytest.raises(InputError, match=r"domain\.file = '\.\./x\.json' is no plain name"):
        read_study(study, {"domain.file": "../x.json"})
    (tmp_path / "bare.toml").write_text('[domain]\nkind = "outlines"\n')
    with pytest.raises(InputError, match=r"domain\.file is missing: it must be a text"):
        read_study(tmp_path / "bare.toml")
