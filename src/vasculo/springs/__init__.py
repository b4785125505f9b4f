"""The mass-spring engine: networks, Hooke forces and the damped motion (eqs. 1-3)."""
