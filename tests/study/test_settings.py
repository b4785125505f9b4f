"""Study files: complete, exact, and refused in one line when they are wrong."""

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.pillars.parameters import Angiogenesis
from vasculo.plexus.parameters import Extraction
from vasculo.study.builtin import NAMES, builtin_path, find_study, titles
from vasculo.study.settings import parse_assignment, parse_study, read_study, toml_value
from vasculo.tissue.parameters import PRESETS, Vasculogenesis

MESH = {"kind": "relaxed", "jitter": 0.2, "boundary": "pinned"}


def parse(text, **overrides):
    return parse_study(text, "study.toml", overrides.get("settings"), overrides.get("label", "settings"))


def test_an_empty_study_has_the_defaults_of_the_stages():
    settings = parse("")
    assert settings.vasculogenesis == Vasculogenesis()
    assert settings.extraction == Extraction()
    assert settings.angiogenesis == Angiogenesis()
    assert settings.stages == ("vasculogenesis", "extraction", "angiogenesis")
    assert settings.tissue == {"nodes": 12_000} | MESH


@pytest.mark.parametrize("name", NAMES)
def test_built_in_studies_are_complete_and_repeatable(name):
    settings = read_study(find_study(name))
    text = settings.to_toml()
    assert parse(text) == settings
    assert parse(text).to_toml() == text
    assert titles()[name] == settings.study.title
    assert "\n" not in settings.study.title


def test_the_stages_of_the_built_in_studies():
    stages = {name: read_study(builtin_path(name)).stages for name in NAMES}
    assert stages["paper"] == stages["small"] == ("vasculogenesis", "extraction", "angiogenesis")
    assert stages["plexus"] == ("vasculogenesis",)
    assert stages["disk"] == stages["chains"] == stages["hanging"] == ("domain", "angiogenesis")
    assert read_study(builtin_path("hanging")).angiogenesis.is_hanging
    assert read_study(builtin_path("paper")).tissue["nodes"] == 12_000


def test_a_study_says_its_format():
    assert parse("").study.format == 1
    assert parse("").to_toml().startswith("[study]\nformat = 1\n")
    assert parse("[study]\nformat = 1") == parse("")
    with pytest.raises(InputError, match=r"^--set: study\.format = 9 is newer than format 1"):
        parse("", settings={"study.format": 9}, label="--set")


def test_a_preset_is_a_start_and_single_keys_replace():
    settings = parse('[vasculogenesis]\npreset = "fine"\ndamping = 4')
    assert settings.vasculogenesis.growth_rate == PRESETS["fine"].growth_rate
    assert settings.vasculogenesis.damping == 4
    assert "preset" not in settings.to_toml()


def test_a_periodic_tissue_has_no_pillars():
    text = "[tissue]\nboundary = 'periodic'\n[study]\nuntil = "
    assert parse(f"{text}'vasculogenesis'").tissue["boundary"] == "periodic"
    with pytest.raises(InputError) as caught:
        parse(f"{text}'extraction'")
    message = "study.toml: tissue.boundary = 'periodic' does not fit study.until = 'extraction': pillars need a frame"
    assert str(caught.value).startswith(message)


def test_a_mesh_that_cannot_be():
    with pytest.raises(InputError, match=r"^study\.toml: tissue\.jitter is 0\.7, expected a number from 0 to 0\.5"):
        parse("[tissue]\njitter = 0.7")
    with pytest.raises(InputError, match=r"^study\.toml: tissue\.kind = 'square' must be one of 'relaxed', 'jittered'"):
        parse("[tissue]\nkind = 'square'")


def test_large_tissues_are_recorded_less_often():
    output = parse("").output
    assert output.growth_interval(35_000) == 5
    assert output.growth_interval(3_000_000) == 8
    assert output.growth_interval(15_000_000) == 20
    assert parse("[output]\ngrowth_every = 3").output.growth_interval(3_000_000) == 3


def test_overrides_replace():
    settings = parse("[tissue]\nnodes = 500", settings={"tissue.nodes": 600, "units.length": 1000})
    assert settings.tissue == {"nodes": 600} | MESH
    assert settings.units.length == 1000


@pytest.mark.parametrize(
    ("text", "pair"),
    [
        ("a.b=3", ("a.b", 3)),
        ("a.b = 1e-3", ("a.b", 1e-3)),
        ("a.b=slip", ("a.b", "slip")),
        ('a.b="x = y"', ("a.b", "x = y")),
        ("a.b=true", ("a.b", True)),
        ("a.b=[1, 2]", ("a.b", [1, 2])),
    ],
)
def test_assignments(text, pair):
    assert parse_assignment(text) == pair


@pytest.mark.parametrize("text", ["a.b", "a.b=", "=3", "="])
def test_no_assignment(text):
    with pytest.raises(InputError, match=r"give section\.key=value"):
        parse_assignment(text)


@pytest.mark.parametrize("value", [True, 3, -0.1, 1e300, 'a"b\\c\nd\te', [1, "x"], 0.1 + 0.2])
def test_toml_values_read_back(value):
    import tomllib

    assert tomllib.loads(f"x = {toml_value(value)}")["x"] == value


WRONG = [
    ("a = 3", "study.toml: unknown section [a] (sections: study, domain, tissue"),
    ("nodes = 3", "study.toml: unknown section [nodes], did you mean tissue.nodes?"),
    ("study = 3", "study.toml: study = 3 stands outside a section"),
    ("[angiogenesi]\nsteps = 3", "study.toml: unknown section [angiogenesi], did you mean [angiogenesis]?"),
    ("[angiogenesis]\nstep = 3", "study.toml: unknown key angiogenesis.step, did you mean angiogenesis.steps?"),
    ("[angiogenesis]\nnodes = 3", "study.toml: unknown key angiogenesis.nodes, did you mean tissue.nodes?"),
    ("[tissue]\nnode = 300\n", "study.toml: unknown key tissue.node, did you mean tissue.nodes?"),
    ("[tissue]\nnodes = '300'\n", "study.toml: tissue.nodes = '300' must be a whole number"),
    ("[tissue]\nnodes = 300.5\n", "study.toml: tissue.nodes = 300.5 must be a whole number"),
    ("[tissue]\nnodes = true\n", "study.toml: tissue.nodes = True must be a whole number"),
    ("[tissue]\nnodes = 3\n", "study.toml: tissue.nodes = 3 is not a whole number from 25 up"),
    ("[vasculogenesis]\ndamping = -1", "study.toml: vasculogenesis.damping is -1"),
    ("[vasculogenesis]\nthreshold = nan", "study.toml: vasculogenesis.threshold is nan"),
    ("[vasculogenesis]\npreset = 'fin'", "study.toml: vasculogenesis.preset = 'fin' must be one of 'fine', 'medium'"),
    ("[vasculogenesis]\nprest = 'fine'", "study.toml: unknown key vasculogenesis.prest, did you mean"),
    ("[angiogenesis]\nactivation = 3.0", "study.toml: angiogenesis.activation = 3.0 is not a number from -0.6 to 0.6"),
    ("[angiogenesis]\nwalls = 'soft'", "study.toml: angiogenesis.walls = 'soft' must be one of 'slip', 'no-slip'"),
    ("[extraction]\nfluid_fraction = 2.0", "study.toml: extraction.fluid_fraction must lie between 0 and 1"),
    ("[domain]\nkind = 'box'", "study.toml: domain.kind = 'box' must be one of 'tissue', 'voronoi', 'disk'"),
    ("[domain]\nkind = 3", "study.toml: domain.kind = 3 must be one of"),
    (
        "[domain]\nkind = 'disk'\n[tissue]\nnodes = 99",
        "study.toml: [tissue] has no use in a study with domain.kind = 'disk'",
    ),
    ("[domain]\nradius = 2.0", "study.toml: unknown key domain.radius"),
    ("[domain]\nkind = 'disk'\nradius = 9.0", "study.toml: [domain] a disk of radius 9"),
    ("[domain]\nkind = 'disk'\n[study]\nuntil = 'extraction'", "study.toml: study.until = 'extraction' does not fit"),
    ("[study]\nuntil = 'plexus'", "study.toml: study.until = 'plexus' must be one of 'vasculogenesis', 'extraction'"),
    ("[study]\nformat = 2\nsoon = 3", "study.toml: study.format = 2 is newer than format 1, the last that vasculo 0."),
    ("[study]\nformat = 2\n[soon]\nx = 3", "study.toml: study.format = 2 is newer than format 1"),
    ("[study]\nformat = 0", "study.toml: study.format = 0 is not a whole number from 1 to 1"),
    ("[study]\nformat = '1'", "study.toml: study.format = '1' must be a whole number"),
    ("[study]\nseed = -1", "study.toml: study.seed = -1 is not a whole number from 0 to 4294967295"),
    ("[output]\nstep_every = 0", "study.toml: output.step_every = 0 is not a whole number from 1 up"),
    ("[units]\nshear = -2.0", "study.toml: units.shear = -2.0 is not a number above 0"),
    ("[study\nseed = 1", "study.toml: not TOML at line 1, column 7: expected ']'"),
    ("[study]\nseed = 1\nseed = 2", "study.toml: not TOML at line 3, column 9: cannot overwrite a value"),
    ("[study]\nseed = ", "study.toml: not TOML at line 2, column 8: invalid value"),
]


@pytest.mark.parametrize(("text", "message"), WRONG)
def test_wrong_studies_are_refused_in_one_line(text, message):
    with pytest.raises(InputError) as caught:
        parse(text)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_several_mistakes_are_counted():
    with pytest.raises(InputError, match=r"unknown key output\.figure, .*\(and 1 more\)"):
        parse("[output]\nfigure = true\nstep_every = 'x'")


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("tissue.node", 30, "--set: unknown key tissue.node, did you mean tissue.nodes?"),
        ("tissue.nodes", "many", "--set: tissue.nodes = 'many' must be a whole number"),
        ("angiogenesis.steps", -1, "--set: angiogenesis.steps = -1 is not a number from 0"),
        ("steps", 3, "--set: 'steps' names no key: give section.key"),
        ("nothing.steps", 3, "--set: unknown section [nothing]"),
    ],
)
def test_a_wrong_override_is_not_blamed_on_the_file(path, value, message):
    with pytest.raises(InputError) as caught:
        parse("[tissue]\nnodes = 99", settings={path: value}, label="--set")
    assert str(caught.value).startswith(message)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(InputError, match=r"no such file and no built-in study, did you mean 'paper'\?"):
        find_study("papr")
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_study(tmp_path / "missing.toml")
    (tmp_path / "bad.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match="is no text file: byte 0"):
        read_study(tmp_path / "bad.toml")
    (tmp_path / "study.toml").write_text("")
    assert find_study(tmp_path) == tmp_path / "study.toml"
    assert find_study(str(tmp_path / "study.toml")) == tmp_path / "study.toml"


def test_numpy_scalars_are_numbers():
    settings = parse("", settings={"angiogenesis.steps": np.int64(2), "vasculogenesis.damping": np.float64(4.0)})
    assert settings.angiogenesis.steps == 2
    assert type(settings.angiogenesis.steps) is int
    assert parse(settings.to_toml()) == settings


@pytest.mark.parametrize(
    ("overrides", "start"),
    [
        ({}, "study.toml: "),
        ({"domain.kind": "tissue"}, "--set: "),
        ({"domain.width": 3.0}, "--set: "),
    ],
)
def test_a_key_of_another_kind_of_domain(overrides, start):
    with pytest.raises(InputError) as caught:
        parse("[domain]\nkind = 'tissue'\nwidth = 12.0", settings=overrides, label="--set")
    text = "unknown key domain.width with domain.kind = 'tissue': it goes with 'voronoi' or 'disk', leave it out"
    assert str(caught.value).startswith(start + text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[tissue]\nnodes = 1000000000", "tissue.nodes = 1000000000 is above 5000000"),
        ("[domain]\nkind = 'voronoi'\npillars = 1" + 26 * "0", "domain.pillars = 1" + 26 * "0"),
        ("[domain]\nkind = 'voronoi'\npad = 1e300", "domain.pad must lie from 0 to 100"),
        ("[domain]\nkind = 'disk'\nwidth = nan", "domain.width must be positive and finite, got nan"),
        ("[domain]\nkind = 'disk'\nradius = 0", "domain.radius must be positive and finite, got 0"),
        ("[extraction]\nspacing = 1e-4", "extraction.spacing must lie from 0.05 to 10, got 0.0001"),
        ("[vasculogenesis]\ndamping = 1e300", "vasculogenesis.damping is 1e+300"),
    ],
)
def test_numbers_beyond_all_bounds(text, message):
    with pytest.raises(InputError) as caught:
        parse(text)
    assert str(caught.value).startswith(f"study.toml: {message}")
