"""What `vasculo check` says before a run: sizes that come true, and times that are told as a span."""

import numpy as np
import pytest

from vasculo import measure
from vasculo.errors import InputError
from vasculo.study.builtin import builtin_path
from vasculo.study.costs import SPREAD, Sizes, memory, record, stage_seconds
from vasculo.study.expected import expected_plexus
from vasculo.study.forecast import _span, forecast, foresee
from vasculo.study.pace import REFERENCE, Pace, measure_pace
from vasculo.study.settings import parse_study, read_study

UNITS = {"units.length": 1000.0, "units.shear": 20.0, "units.viscosity": 3.0}


def parse(text="", **settings):
    return parse_study(text, "study.toml", {name.replace("__", "."): value for name, value in settings.items()})


def told(settings):
    return dict(forecast(settings))


def number(text):
    return float(text.removeprefix("about ").split()[0])


def test_what_a_tissue_becomes_is_foreseen(tissue_run, tiny_tissue):
    settings = read_study(builtin_path("small"), tiny_tissue)
    sizes = foresee(settings, Pace()).sizes
    first, growth = tissue_run.domain(0), tissue_run.metrics["stage"] == "vasculogenesis"
    assert sizes.springs == tissue_run.metrics["springs"][0]
    assert sizes.time_steps == pytest.approx(tissue_run.metrics["step"][growth][-1], rel=0.1)
    assert sizes.pillars == pytest.approx(len(first.pillars), rel=0.5)  # of a few voids the law can say little
    assert sizes.growth_frames == pytest.approx(growth.sum(), rel=0.3)
    assert record(sizes) == pytest.approx(tissue_run.path.stat().st_size / 1e6, rel=0.5)


def test_what_a_plexus_has_is_foreseen(tissue_run, tiny_tissue):
    """Of as many pillars as there are, and as much fluid: sizes and flow of equal hexagons come near."""
    settings = read_study(builtin_path("small"), tiny_tissue)
    domain, flow = tissue_run.domain(0), tissue_run.flow(0)
    fluid = 1.0 - domain.pillar_areas.sum()
    wanted = read_study(builtin_path("small"), tiny_tissue | {"extraction.fluid_fraction": fluid})
    found = expected_plexus(len(domain.pillars), 0.04, wanted.extraction, settings.angiogenesis)
    passages = measure.passages(domain)
    assert found.radius == pytest.approx(domain.mean_radius, rel=0.15)
    assert found.width == pytest.approx(passages.width[passages.between_pillars].mean(), rel=0.3)
    rows = tissue_run.metrics["stage"] == "angiogenesis"
    assert found.triangles == pytest.approx(tissue_run.metrics["triangles"][rows][0], rel=0.4)
    assert found.shear == pytest.approx(tissue_run.metrics["mean_wall_shear"][rows][0], rel=0.4)
    speed = np.average(np.hypot(*flow.velocity.T), weights=flow.mesh.areas)
    assert found.speed == pytest.approx(speed, rel=0.6)


def test_a_drawn_domain_is_meshed_and_its_flow_solved(disk_run, tiny_disk):
    settings = read_study(builtin_path("disk"), tiny_disk | UNITS)
    found = told(settings)
    assert found["flow mesh"] == f"{disk_run.metrics['triangles'][0]:.0f} triangles at the start"
    shear = disk_run.metrics["mean_wall_shear"][0]
    assert found["mean wall shear"] == f"{20.0 * shear:.3g} dyn/cm²"
    flow = disk_run.flow(0)
    speed = np.average(np.hypot(*flow.velocity.T), weights=flow.mesh.areas)
    assert number(found["mean speed"]) == pytest.approx(speed * settings.units.factor("velocity"), rel=6e-3)
    assert found["mean speed"].endswith(" µm/s")


def test_lengths_are_told_in_the_units_of_the_study():
    plain, physical = (told(parse(tissue__nodes=400, **more)) for more in ({}, {"units__length": 500.0}))
    for name in ("mean spring length", "expected spacing", "pillar radius R0", "tubule width"):
        assert plain[name].endswith(" model length")
        assert physical[name].endswith(" µm")
        assert number(physical[name]) == pytest.approx(500.0 * number(plain[name]), rel=0.01)
    assert plain["mean wall shear"].endswith(" model pressure")
    assert physical["mean speed"].endswith(" model velocity")  # needs the shear and the viscosity too


def test_a_speed_in_micrometres_does_not_depend_on_the_model_viscosity():
    names = {name.replace(".", "__"): value for name, value in UNITS.items()}
    one, other = (
        told(parse("[domain]\nkind = 'disk'", angiogenesis__viscosity=value, **names))["mean speed"]
        for value in (1.0, 5.0)
    )
    assert one == other
    model, thick = (
        told(parse("[domain]\nkind = 'disk'", angiogenesis__viscosity=value))["mean speed"] for value in (1.0, 5.0)
    )
    assert number(model) == pytest.approx(5.0 * number(thick), rel=6e-3)


def test_stages_that_do_not_run_are_not_told():
    lines = told(parse(tissue__nodes=400, study__until="vasculogenesis"))
    assert not {"geometry steps", "mean speed", "tubule width", "flow mesh"} & lines.keys()
    assert "expected spacing" in lines
    lines = told(parse(tissue__nodes=400, study__until="extraction"))
    assert "tubule width" in lines
    assert "flow mesh" not in lines


def test_more_costs_more():
    small = Sizes(nodes=1000, springs=3000, time_steps=2000, looks=200, growth_frames=40)
    for name in ("springs", "time_steps", "looks", "growth_frames"):
        more = Sizes(**{**vars(small), name: 10 * getattr(small, name)})
        assert sum(stage_seconds(more).values()) > sum(stage_seconds(small).values())
    one, two = (stage_seconds(Sizes(nodes=45_000, springs=134_000, time_steps=2000), threads) for threads in (1, 2))
    assert one["vasculogenesis"] > two["vasculogenesis"]
    assert stage_seconds(small).keys() == {"vasculogenesis", "pictures"}
    assert stage_seconds(Sizes(steps=3, triangles=1e4, figures=False)).keys() == {"angiogenesis"}
    assert memory(Sizes(steps=3, first_triangles=1e5, figures=False)) < memory(Sizes(steps=3, first_triangles=1e5))


def test_a_slower_machine_takes_longer():
    settings = parse(tissue__nodes=400, angiogenesis__steps=3)
    usual, slow = (foresee(settings, Pace(REFERENCE * factor)) for factor in (1.0, 3.0))
    assert slow.seconds == pytest.approx(3.0 * usual.seconds)
    assert slow.memory == usual.memory
    assert "busy" not in Pace().words
    assert Pace(busy=4.0).words.endswith("1 thread; this machine is busy, it takes 4.0 times as long now")


def test_the_pace_of_this_machine():
    found = measure_pace()
    assert 0.1 < found.factor < 30.0
    assert found.busy >= 1.0
    assert found.threads >= 1


def test_the_time_is_told_as_a_span():
    lines = told(parse(tissue__nodes=400))
    low, _, rest = lines["expected time"].partition(" to ")
    assert 1.0 < float(rest.split()[0]) / float(low) <= SPREAD**2 * 1.2
    assert lines["based on"].endswith((" thread", " threads", "as long now"))


def test_the_forecast_writes_short_numbers():
    slow = {"tissue__nodes": 100, "vasculogenesis__growth_rate": 1e-6, "vasculogenesis__time_step": 1e-6}
    lines = told(parse(**slow, vasculogenesis__hold=1e6))
    assert "days" in lines["expected time"]
    assert max(len(text) for name, text in lines.items() if name != "based on") < 80
    many = told(parse(tissue__nodes=100, vasculogenesis__growth_rate=1e6))
    assert many["expected pillars"] == "about 3"  # the law ends at the load 0.06
    assert many["expected spacing"] == "0.539 model length"


@pytest.mark.parametrize(
    ("low", "high", "words"),
    [
        (60, 89, "60 to 89 s"),
        (90, 180, "2 to 3 min"),
        (3600, 7200, "60 to 120 min"),
        (7200, 14400, "2 to 4 h"),
        (864000, 1e6, "10 to 12 days"),
    ],
)
def test_spans(low, high, words):
    assert _span(low, high) == words


def test_a_step_beyond_the_limit_is_refused():
    with pytest.raises(InputError, match=r"vasculogenesis.time_step = 5 exceeds the stability limit"):
        forecast(parse(tissue__nodes=400, vasculogenesis__time_step=5.0))
