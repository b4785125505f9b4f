"""The checkpoint: everything comes back, and it is whole or not there."""

import h5py
import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.store import checkpoint as module
from vasculo.store.checkpoint import Checkpoint
from vasculo.tissue.lattice import lattice


def moved_network():
    network = lattice(200, 2)
    network.damping, network.tether = 0.7, 0.01
    network.points[5] += 0.01
    network.velocities[:] = 0.25
    return network


def test_everything_comes_back(tmp_path, fab):
    path = tmp_path / "checkpoint.h5"
    pillars = [fab.circle(1.0, 1.0, 0.4), fab.circle(3.0, 1.0, 0.5)]
    domain = Domain.rectangle(4.0, 2.0, pillars)
    before = Checkpoint(
        fab.STUDY, 12, [{"name": "vasculogenesis", "seconds": 2.0}], moved_network(), domain, "law = 1\n"
    )
    before.save(path)
    after = Checkpoint.load(path)
    assert (after.settings, after.frames, after.stages, after.laws) == (fab.STUDY, 12, before.stages, before.laws)
    for name in (*module._NETWORK, "damping", "tether"):
        np.testing.assert_array_equal(getattr(after.plexus, name), getattr(before.plexus, name), err_msg=name)
    np.testing.assert_array_equal(after.domain.outer, domain.outer)
    assert after.domain.sides == domain.sides
    for one, two in zip(after.domain.pillars, domain.pillars, strict=True):
        np.testing.assert_array_equal(one, two)


def test_a_domain_without_pillars_too(tmp_path, fab):
    Checkpoint(fab.STUDY, domain=Domain.rectangle(4.0, 2.0)).save(tmp_path / "checkpoint.h5")
    assert Checkpoint.load(tmp_path / "checkpoint.h5").domain.pillars == ()


def test_a_periodic_network_too(tmp_path, fab):
    network = lattice(200, 2, boundary="periodic")
    network.points += 0.75  # over the seam
    Checkpoint(fab.STUDY, plexus=network).save(tmp_path / "checkpoint.h5")
    after = Checkpoint.load(tmp_path / "checkpoint.h5").plexus
    assert after.box.tolist() == [1.0, 1.0]
    np.testing.assert_array_equal(after.lengths(), network.lengths())


def test_an_empty_one_too(tmp_path, fab):
    Checkpoint(fab.STUDY).save(tmp_path / "checkpoint.h5")
    after = Checkpoint.load(tmp_path / "checkpoint.h5")
    assert (after.frames, after.plexus, after.domain, after.laws) == (0, None, None, "")


def test_a_failed_save_leaves_the_one_before(tmp_path, monkeypatch, fab):
    path = tmp_path / "checkpoint.h5"
    Checkpoint(fab.STUDY, 1).save(path)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    with pytest.raises(OSError, match="No space"):
        Checkpoint(fab.STUDY, 2).save(path)
    assert Checkpoint.load(path).frames == 1
    assert [file.name for file in tmp_path.iterdir()] == ["checkpoint.h5"]


def test_missing_damaged_and_foreign(tmp_path):
    path = tmp_path / "checkpoint.h5"
    with pytest.raises(InputError, match=r"there is no checkpoint\.h5"):
        Checkpoint.load(path)
    path.write_bytes(b"rubbish")
    with pytest.raises(InputError, match="no readable checkpoint"):
        Checkpoint.load(path)
    for number in (1, 7):
        with h5py.File(path, "w") as file:
            file.attrs["format"] = number
        with pytest.raises(InputError, match=f"checkpoint format {number}, .* can be looked at but not continued"):
            Checkpoint.load(path)
