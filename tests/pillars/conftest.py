"""Runs that several tests look at; each is made once."""

from __future__ import annotations

import numpy as np
import pytest
from tests.pillars.shapes import disk_domain, record, shape

from vasculo.geometry.outline import signed_area
from vasculo.pillars.angiogenesis import Angiogenesis


@pytest.fixture(scope="session")
def disk_run():
    """The disk of Fig 4, 20 steps."""
    return record(disk_domain(), Angiogenesis(steps=20))[1]


@pytest.fixture(scope="session")
def disk_numbers(disk_run):
    """A row a step: aspect ratio, angle, sd of the activation, area, flow rate."""
    rows = []
    for step in disk_run:
        ratio, angle = shape(step.domain.pillars[0])
        rows.append(
            (
                ratio,
                angle,
                step.activation[0].std(),
                signed_area(step.domain.pillars[0]),
                step.flow.flow_rate("right"),
            )
        )
    return np.array(rows)
