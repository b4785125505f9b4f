"""What a notebook shows of an object: asked for by name, so that nothing here knows of pictures."""

from __future__ import annotations

from importlib import import_module


class Shown:
    """A class whose objects show themselves in a notebook: a small picture and their key numbers.

    The picture is made by `vasculo.draw.inline`, which is loaded when a notebook asks: the one import that does not
    point down.
    """

    __slots__ = ()

    def _repr_html_(self) -> str:
        return str(import_module("vasculo.draw.inline").html(self))
