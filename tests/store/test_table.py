"""The table: exact numbers, empty cells, and files that are whole or not there."""

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.store.table import COLUMNS, COUNTS, MEANINGS, from_csv, to_csv, write_whole


def test_the_columns_are_those_of_the_interface():
    assert ",".join(COLUMNS) == (
        "stage,step,time,springs,void_fraction,pillars,merges,order,alignment,aspect_ratio,angle,mean_gap,"
        "permeability,mean_wall_shear,triangles,residual,mass_imbalance,seconds,local_angle,chains,largest_chain,"
        "chain_fraction,straightness,resistance,shear_variation,shear_ratio,corridors,corridor_width,corridor_run,"
        "events,seconds_mesh,seconds_flow,seconds_cells"
    )
    assert set(MEANINGS) == set(COLUMNS)
    assert set(COUNTS) < set(COLUMNS)


def test_round_trip(tmp_path):
    columns = {"step": np.array([0.0, 7.0]), "order": np.array([np.nan, 0.1 + 0.2]), "time": np.array([1e-300, 1 / 3])}
    text = to_csv(["vasculogenesis", "angiogenesis"], columns)
    assert text.splitlines()[0] == ",".join(COLUMNS)
    assert text.splitlines()[2].startswith("angiogenesis,7,0.333")
    path = tmp_path / "t.csv"
    path.write_text(text)
    stages, back = from_csv(path)
    assert stages == ["vasculogenesis", "angiogenesis"]
    for name, values in columns.items():
        np.testing.assert_array_equal(back[name], values)
    assert np.isnan(back["pillars"]).all()


def test_another_table_is_refused(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="no table of a run"):
        from_csv(path)


def test_a_file_is_whole_or_not_there(tmp_path, monkeypatch):
    path = tmp_path / "t.csv"
    write_whole(path, "one")

    def full(self, data):
        with self.open("wb") as file:
            file.write(data[:2])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(OSError, match="No space"):
        write_whole(path, "another")
    assert path.read_text() == "one"
    assert [file.name for file in tmp_path.iterdir()] == ["t.csv"]
