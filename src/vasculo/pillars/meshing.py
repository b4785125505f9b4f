"""A flow mesh that is carried along with the pillars while it can be, and made anew where it cannot."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.repair.follow import follow_mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.mesh.triangulation import Triangulation


class FreshMesh:
    """Makes every mesh of a run anew; to be called like `generate_mesh`."""

    def __call__(
        self, domain: Domain, edge_length: float, wall_edge_length: float, *, across: float = 0.0
    ) -> Triangulation:
        """Mesh a domain; see `generate_mesh`."""
        return generate_mesh(domain, edge_length, wall_edge_length, across=across)

    def base_points(self, _domain: Domain) -> NDArray[np.float64]:
        """Give what a checkpoint needs: nothing, (0, 2) float64."""
        return np.zeros((0, 2))


class CarriedMesh:
    """Makes the meshes of a run; to be called like `generate_mesh`, with the same lengths each time.

    A mesh is always carried from the one that was last made anew, never from one that was carried itself. So it is
    known from two domains, the one it was made for and the present one, and a run can be taken up from these two.

    Parameters
    ----------
    base : Domain, optional
        Domain for which the mesh was last made anew, in a run that is taken up.

    Attributes
    ----------
    base : Domain or None
    how : {"", "anew", "carried"}
        Where the last mesh came from.
    """

    def __init__(self, base: Domain | None = None) -> None:
        self.base = base
        self.how = ""
        self._mesh: Triangulation | None = None

    def __call__(
        self, domain: Domain, edge_length: float, wall_edge_length: float, *, across: float = 0.0
    ) -> Triangulation:
        """Mesh a domain.

        Parameters
        ----------
        domain : Domain
        edge_length, wall_edge_length, across
            As in `generate_mesh`.

        Returns
        -------
        Triangulation

        Raises
        ------
        InputError, ComputationError
            As `generate_mesh`.
        """
        if self.base is not None:
            if self._mesh is None:
                self._mesh = generate_mesh(self.base, edge_length, wall_edge_length, across=across)
            carried = follow_mesh(self._mesh, self.base, domain)
            if carried is not None:
                self.how = "carried"
                return carried
        self.base, self._mesh = domain, generate_mesh(domain, edge_length, wall_edge_length, across=across)
        self.how = "anew"
        return self._mesh

    def base_points(self, domain: Domain) -> NDArray[np.float64]:
        """Give what a checkpoint needs: the outline nodes of `base`, in the layout of those of the present domain.

        Returns
        -------
        (n, 2) float64, model length
            Empty, (0, 2), where the outlines have other nodes: the next mesh is then made anew in any case.
        """
        if self.base is None or [len(k) for k in self.base.pillars] != [len(k) for k in domain.pillars]:
            return np.zeros((0, 2))
        return np.concatenate(self.base.pillars)
