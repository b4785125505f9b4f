"""The viewer: a record, or a run on its way, in the browser or in a window of its own."""
