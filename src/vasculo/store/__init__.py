"""Storage: one VTKHDF file a run, a checkpoint to go on from, and the way back into memory."""
