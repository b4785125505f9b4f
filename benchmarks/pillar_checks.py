"""Ten checks of the flow-driven stage: what a disk, an array of pillars and their controls must do.

Run: python -m benchmarks.pillar_checks [--only 3 5] [--layouts 16]
The checks are: 1 wall shear on a disk, 2 modulus of the filaments, 3 the disk of Fig 4, 4 filaments that remember,
5 symmetries and units, 6 number of membrane nodes, 7 arrays of sixteen, 8 activation without information, 9 hanging
pillars, 10 an array of 64. Each line of the table says what was asked, what was measured, and whether it holds; the
seconds are processor time. The exit status is the number of checks that fail.
"""

from __future__ import annotations

import argparse
import sys
from functools import partial
from typing import TYPE_CHECKING

from benchmarks.pillar_arrays import array_of_64, arrays_of_sixteen, hanging_pillars, no_information
from benchmarks.pillar_runs import Row, print_table
from benchmarks.pillar_single import (
    disk_of_fig_4,
    filaments_that_remember,
    modulus_of_the_filaments,
    number_of_nodes,
    symmetries_and_units,
    wall_shear_on_a_disk,
)

if TYPE_CHECKING:
    from collections.abc import Callable

CHECKS: dict[int, Callable[[], list[Row]]] = {
    1: wall_shear_on_a_disk,
    2: modulus_of_the_filaments,
    3: disk_of_fig_4,
    4: filaments_that_remember,
    5: symmetries_and_units,
    6: number_of_nodes,
    7: arrays_of_sixteen,
    8: no_information,
    9: hanging_pillars,
    10: array_of_64,
}


def main() -> int:
    """Make the checks that are asked for and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", type=int, nargs="+", choices=CHECKS, default=list(CHECKS), help="checks to make")
    parser.add_argument("--layouts", type=int, default=16, choices=range(4, 17), help="blocks of check 7, 4 to 16")
    options = parser.parse_args()
    return print_table(CHECKS | {7: partial(arrays_of_sixteen, options.layouts)}, options.only)


if __name__ == "__main__":
    sys.exit(main())
