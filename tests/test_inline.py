"""What notebooks and prompts show of the objects people handle."""

import base64
import io
import re
import subprocess
import sys
import time
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image
from tests.store.conftest import STUDY, fill

import vasculo as vc
from vasculo.draw.inline import html
from vasculo.draw.page import TIMES
from vasculo.store.record import Record

TURN = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
DISK = np.stack([1.0 + 0.2 * np.cos(TURN), 0.5 + 0.2 * np.sin(TURN)], axis=1)


class Balanced(HTMLParser):
    """Fails where a tag is closed that is not open."""

    def __init__(self):
        super().__init__()
        self.open, self.cells = [], []

    def handle_starttag(self, tag, _):
        if tag != "img":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] == "td":
            self.cells.append(data)


def table(text):
    """The table of a piece of HTML, as a dict."""
    parser = Balanced()
    parser.feed(text)
    assert parser.open == []
    return dict(zip(parser.cells[::2], parser.cells[1::2], strict=True))


def picture(text):
    """The picture of a piece of HTML."""
    code = re.search(r'src="data:image/webp;base64,([^"]*)"', text)[1]
    return Image.open(io.BytesIO(base64.b64decode(code)))


@pytest.fixture(scope="module")
def domain():
    return vc.Domain.rectangle(3.0, 1.0, [DISK])


@pytest.fixture(scope="module")
def mesh(domain):
    return vc.generate_mesh(domain, edge_length=0.2)


@pytest.fixture(scope="module")
def flow(mesh):
    return vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A complete run of fabricated steps whose folder has a name that HTML must not take as it is."""
    path = tmp_path_factory.mktemp("a<b>&") / "run.vtkhdf"
    record = Record.create(path, STUDY + "[units]\nlength = 1000.0\n", "0")
    fill(record)
    record.finish()
    record.close()
    return vc.open_run(path)


def test_a_domain(domain):
    assert repr(domain) == "Domain(3 x 1, pillars: 1, sides: bottom, left, right, top)"
    rows = table(domain._repr_html_())
    assert rows["size"] == f"3 {TIMES} 1"
    assert rows["pillars"] == "1"
    assert float(rows["share of fluid"]) == pytest.approx(1.0 - domain.pillar_areas.sum() / 3.0, abs=1e-4)
    shown = np.asarray(picture(domain._repr_html_()).convert("RGB"), dtype=int)
    height, width, _ = shown.shape
    pillar, fluid = shown[height // 2, width // 3], shown[height // 2, 2 * width // 3]
    assert pillar[0] > pillar[2] + 30, "tissue is warm"
    assert fluid[2] > fluid[0], "fluid is cool"


def test_what_was_mended_is_told():
    assert "clockwise" in vc.Domain.rectangle(3.0, 1.0, [DISK[::-1]])._repr_html_()


def test_a_mesh(mesh):
    assert repr(mesh).startswith(f"Triangulation({len(mesh.points)} nodes, {len(mesh.triangles)} triangles")
    rows = table(mesh._repr_html_())
    assert rows["triangles"] == f"{len(mesh.triangles):,}"
    assert rows["quality of a triangle"].endswith(f"{mesh.quality().min():.3f} worst")


def test_a_flow(flow):
    assert repr(flow).startswith(f"Flow({len(flow.mesh.triangles)} triangles, viscosity 1")
    rows = table(flow._repr_html_())
    assert float(rows["outflow through right"]) == pytest.approx(flow.flow_rate("right"), rel=1e-3)
    assert "outflow through top" not in rows
    assert float(rows["error of the mass balance"]) < 1e-6


def test_a_network():
    tissue = vc.lattice(nodes=200, seed=1, boundary="periodic")
    assert repr(tissue) == f"SpringNetwork(200 nodes, 0 of them pinned, {len(tissue.springs)} springs)"
    rows = table(tissue._repr_html_())
    assert rows["nodes"] == "200"
    assert float(rows["mean length of a spring"]) == pytest.approx(tissue.lengths().mean(), rel=1e-3)
    assert rows["repeats every"] == f"1 {TIMES} 1"


def test_a_run_and_its_steps(run):
    assert repr(run).endswith("complete, 7 recorded steps)")
    text = run._repr_html_()
    assert "a<b>" not in text
    assert "a&lt;b&gt;&amp;" in text
    rows = table(text)
    assert rows["angiogenesis"] == "4 recorded steps, the last one is 3"
    assert rows["permeability"].endswith("µm²")
    assert "Note" not in text
    assert repr(run.flow()).startswith("FlowFields(")
    assert table(run.flow()._repr_html_())["pillars"] == "2"
    assert repr(run.network()) == f"Springs(60 nodes, {len(run.network().springs)} springs)"
    assert table(run.network()._repr_html_())["nodes"] == "60"
    assert repr(run.pillars()) == "Pillars(2 of 3 original ones)"


@pytest.mark.parametrize(
    "thing",
    [
        vc.Domain.rectangle(1.0, 1.0),
        vc.Domain.rectangle(1.0, 80.0),
        vc.SpringNetwork([[0.0, 0.0], [1.0, 1.0]], np.empty((0, 2), dtype=int)),
        vc.SpringNetwork([[0.5, 0.5]], np.empty((0, 2), dtype=int)),
        vc.SpringNetwork([[0.0, 0.0], [1.0, 0.0]], [[0, 1]], rest_lengths=0.0),
    ],
    ids=["no pillars", "a slit", "no springs", "one node", "springs of no length"],
)
def test_odd_things_show_themselves(thing):
    text = thing._repr_html_()
    assert table(text)
    assert min(picture(text).size) > 0
    assert "nan" not in text.split("<table")[1]


def test_a_run_without_steps_shows_its_table(tmp_path):
    record = Record.create(tmp_path / "run.vtkhdf", STUDY, "0")
    record.close()
    text = vc.open_run(tmp_path)._repr_html_()
    assert "<img" not in text
    assert "incomplete: the run stopped before its end" in text
    assert table(text)["seed"] == "3"


def test_a_large_tissue_is_small_and_quick():
    tissue = vc.lattice(nodes=12_000, seed=1)
    tissue._repr_html_()
    begin = time.process_time()
    text = tissue._repr_html_()
    assert time.process_time() - begin < 1.0  # 0.3 s on an idle machine
    assert len(text) < 60_000


def test_without_matplotlib_there_is_the_table():
    code = (
        "import sys\nsys.modules['matplotlib'] = None\nimport vasculo as vc\n"
        "print(vc.Domain.rectangle(2.0, 1.0)._repr_html_())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "<img" not in done.stdout
    assert table(done.stdout)["size"] == f"2 {TIMES} 1"


def test_another_object_is_refused():
    with pytest.raises(vc.InputError, match="int has no picture for notebooks"):
        html(3)
