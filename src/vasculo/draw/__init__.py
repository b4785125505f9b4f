"""Pictures and the report of a run, from arrays or from its record."""
