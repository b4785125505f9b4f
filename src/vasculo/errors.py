"""The two ways in which a call can end badly."""


class InputError(ValueError):
    """What was given cannot be used; the one-line message says what, where and what would be right."""


class ComputationError(RuntimeError):
    """A computation did not get there; the one-line message carries the numbers at which it stopped."""
