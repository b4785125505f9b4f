"""What a solver may keep from one flow to the next: the analysis of a matrix whose pattern has not changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from vasculo.flow.linear.pardiso import Analysis


class KeptAnalysis:
    """Order of elimination and symbolic factors of the last matrix, for the next one; empty at first.

    They are used again where the next matrix has the same pattern, as it has when a mesh moves and keeps its
    triangles, and where PARDISO factors it ("direct", "compact"); the solution is the same to the last bit. SuperLU
    goes without: its order follows the places of the cells. Whoever makes this object owns the memory behind it
    (`bytes`), which goes with it. A copy, and what comes back from a pickle, is empty.
    """

    def __init__(self) -> None:
        self._analysis: Analysis | None = None

    def __reduce__(self) -> tuple[type[KeptAnalysis], tuple[()]]:
        return type(self), ()

    @property
    def bytes(self) -> int:
        """Bytes that it holds."""
        return 0 if self._analysis is None else self._analysis.bytes

    def take(self, start: NDArray[np.int32], columns: NDArray[np.int32]) -> Analysis | None:
        """Hand out the analysis if it is one of this pattern, (t + 1,) and (k,) int32; it is let go of either way."""
        found, self._analysis = self._analysis, None
        if found is not None and not found.fits(start, columns):
            found.close()
            return None
        return found

    def keep(self, analysis: Analysis) -> None:
        """Take an analysis in, whose factors have been released."""
        self._analysis = analysis
