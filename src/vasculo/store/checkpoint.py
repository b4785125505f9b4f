"""The checkpoint of a run: what its finished stages leave to the next, in one file that is always whole.

Within the angiogenesis a run goes on from the last state in its record.
"""

from __future__ import annotations

import io
import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.springs.network import SpringNetwork
from vasculo.store.guarded import uninterrupted
from vasculo.store.record import first_line
from vasculo.store.table import write_whole

if TYPE_CHECKING:
    from pathlib import Path

FORMAT = 2
_NODES = ("points", "velocities", "masses", "pinned", "reference")
_NETWORK = (*_NODES, "springs", "rest_lengths", "stiffness", "triangles", "box")


@dataclass
class Checkpoint:
    """How far a run has come.

    Attributes
    ----------
    settings : str
        The resolved study, as TOML.
    frames : int
        Frames in the record behind the last finished stage.
    stages : list of dict
        Finished stages, in order: name, seconds, peak memory, what came out.
    plexus : SpringNetwork, optional
        The remodelled tissue, once there.
    domain : Domain, optional
        The domain before the remodelling, once there.
    laws : str
        Text of the Python file that the study uses; empty when there is none.
    """

    settings: str
    frames: int = 0
    stages: list[dict[str, Any]] = field(default_factory=list)
    plexus: SpringNetwork | None = None
    domain: Domain | None = None
    laws: str = ""

    def save(self, path: Path) -> None:
        """Write the checkpoint; the one before stays until this one is whole.

        Raises
        ------
        OSError
            When it cannot be written.
        """
        memory = io.BytesIO()
        with uninterrupted():
            with h5py.File(memory, "w") as file:
                self._write(file)
            write_whole(path, memory.getvalue())

    def _write(self, file: h5py.File) -> None:
        file.attrs.update({"format": FORMAT, "frames": self.frames})
        file["settings"] = self.settings
        file["stages"] = json.dumps(self.stages)
        file["laws"] = self.laws
        if self.plexus is not None:
            group = file.create_group("plexus")
            group.attrs.update({"damping": self.plexus.damping, "tether": self.plexus.tether})
            for name in _NETWORK:
                if (value := getattr(self.plexus, name)) is not None:
                    group[name] = value
        if self.domain is not None:
            group = file.create_group("domain")
            group["outer"] = self.domain.outer
            group["sides"] = json.dumps(self.domain.sides)
            group["pillars"] = np.concatenate([*self.domain.pillars, np.empty((0, 2))])
            group["sizes"] = np.array([len(pillar) for pillar in self.domain.pillars], dtype=np.int64)

    @classmethod
    def load(cls, path: Path) -> Checkpoint:
        """Read a checkpoint.

        Raises
        ------
        InputError
            When there is none, or it is of another kind or damaged.
        """
        if not path.is_file():
            raise InputError(f"{path.parent} cannot be continued: there is no {path.name}")
        try:
            with h5py.File(path) as file:
                if file.attrs["format"] != FORMAT:
                    raise InputError(
                        f"{path} has checkpoint format {file.attrs['format']}, this version reads {FORMAT}: "
                        f"the run can be looked at but not continued, start it anew in another folder"
                    )
                return cls(
                    settings=file["settings"].asstr()[()],
                    frames=int(file.attrs["frames"]),
                    stages=json.loads(file["stages"].asstr()[()]),
                    plexus=_network(file["plexus"]) if "plexus" in file else None,
                    domain=_domain(file["domain"]) if "domain" in file else None,
                    laws=file["laws"].asstr()[()],
                )
        except (OSError, KeyError) as error:
            raise InputError(f"{path} is no readable checkpoint ({first_line(error)}): start the run anew") from None


def _network(group: h5py.Group) -> SpringNetwork:
    """Rebuild a network; it is made at its initial positions, which it keeps, and then moved."""
    data = {name: group[name][:] for name in _NETWORK if name in group}
    network = SpringNetwork(
        data["reference"],
        data["springs"],
        data["rest_lengths"],
        data["stiffness"],
        data["masses"],
        float(group.attrs["damping"]),
        data["pinned"],
        triangles=data.get("triangles"),
        tether=float(group.attrs["tether"]),
        box=data.get("box"),
    )
    network.points[:] = data["points"]
    network.velocities[:] = data["velocities"]
    return network


def _domain(group: h5py.Group) -> Domain:
    pillars = np.split(group["pillars"][:], np.cumsum(group["sizes"][:]))[:-1]
    return Domain(group["outer"][:], pillars, json.loads(group["sides"].asstr()[()]))
