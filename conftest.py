"""Tests of the whole repository."""

import vasculo.measure  # noqa: F401  # as a whole, before pytest loads its files one by one for their examples
