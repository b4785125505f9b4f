"""The checkpoint of a run: all it needs to go on to the same numbers, in one file that is always whole."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import h5py

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.pillars.state import RemodelState
from vasculo.springs.network import SpringNetwork
from vasculo.store.guarded import uninterrupted
from vasculo.store.record import first_line
from vasculo.store.table import write_whole

if TYPE_CHECKING:
    from pathlib import Path

FORMAT = 1
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
        Frames in the record at this point.
    stages : list of dict
        Finished stages, in order: name, seconds, peak memory, what came out.
    plexus : SpringNetwork, optional
        The remodelled tissue, once there.
    domain : Domain, optional
        The domain before the remodelling, once there.
    state : RemodelState, optional
        The remodelling after its last step, once begun.
    seconds : float
        Wall time spent on the unfinished stage so far.
    """

    settings: str
    frames: int = 0
    stages: list[dict[str, Any]] = field(default_factory=list)
    plexus: SpringNetwork | None = None
    domain: Domain | None = None
    state: RemodelState | None = None
    seconds: float = 0.0

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
        file.attrs.update({"format": FORMAT, "frames": self.frames, "seconds": self.seconds})
        file["settings"] = self.settings
        file["stages"] = json.dumps(self.stages)
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
            for number, pillar in enumerate(self.domain.pillars):
                group[f"pillars/{number:06d}"] = pillar
        if self.state is not None:
            group = file.create_group("state")
            for name, array in self.state.arrays().items():
                group[name] = array

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
                        f"{path} has checkpoint format {file.attrs['format']}, this version reads {FORMAT}"
                    )
                return cls(
                    settings=file["settings"].asstr()[()],
                    frames=int(file.attrs["frames"]),
                    stages=json.loads(file["stages"].asstr()[()]),
                    plexus=_network(file["plexus"]) if "plexus" in file else None,
                    domain=_domain(file["domain"]) if "domain" in file else None,
                    state=_state(file["state"]) if "state" in file else None,
                    seconds=float(file.attrs["seconds"]),
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
    pillars = [group["pillars"][name][:] for name in sorted(group["pillars"])] if "pillars" in group else []
    return Domain(group["outer"][:], pillars, json.loads(group["sides"].asstr()[()]))


def _state(group: h5py.Group) -> RemodelState:
    return RemodelState.from_arrays({name: data[()] for name, data in group.items()})
