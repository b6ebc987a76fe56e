"""Residual and matrix of the equations of a scene at states of one's own."""

import numpy as np

import fem_lie as fl
from fem_lie import lie
from fem_lie.extend import node_types


class Assembled:
    """The equations of a scene, as solvers see them, with dense results.

    Attributes:
        equations: These equations.
        count: Number of moving nodes; size: number of unknowns, multipliers included.
        start: Frames from which solvers start; ``H`` of any state has these rows.
    """

    def __init__(self, scene: fl.Scene, *, dynamics: bool, **options) -> None:
        self.equations = fl.extend.Equations(scene, dynamics=dynamics, **options)
        unknowns = self.equations.unknowns
        self.count, self.m, self.size = unknowns.moving, unknowns.m, unknowns.size
        self.kinds, self.held = unknowns.kinds, unknowns.held
        self.start = self.equations.start.frames

    def moved(self, H: np.ndarray, h: np.ndarray) -> np.ndarray:
        """All frames with the moving ones displaced by local increments ``h``, (n, 6)."""
        there, n = np.array(H), self.count
        # on SE(3), whatever the group on which a frame moves in time
        types = node_types.at_rest(self.kinds)
        node_types.retract_all(types, np.ascontiguousarray(H[:n]), h, there[:n])
        return there

    def tilted(self, H: np.ndarray, h: np.ndarray) -> np.ndarray:
        """The same along the motion of shells: ``x + R u``, tilted, and then drilled."""
        there, n = np.array(H), self.count
        tilt, drill = np.zeros((2, n, 6))
        tilt[:, 3:5], drill[:, 5] = h[:, 3:5], h[:, 5]
        there[:n] = lie.se3_retract(lie.se3_retract(H[:n], tilt), drill)
        there[:n, 0] += np.einsum("nij,ni->nj", H[:n, 1:], h[:, :3])
        return there

    def state(self, H, v=None, a=None, multipliers=None) -> fl.extend.TimeState:
        """A state; at rest and without constraint forces by default."""
        none = np.zeros((self.count, 6))
        return fl.extend.TimeState(
            H,
            none if v is None else v,
            none if a is None else a,
            np.zeros(self.m) if multipliers is None else multipliers,
        )

    def residual(self, H, v=None, a=None, multipliers=None) -> np.ndarray:
        """The residual, (size,)."""
        r = np.zeros(self.size)
        self.equations.residual(self.state(H, v, a, multipliers), np.ones(self.m), r)
        return r

    def matrix(self, H, v=None, a=None, multipliers=None, *, mass=0.0, damping=0.0) -> np.ndarray:
        """The derivative of the residual with the stress of the state, dense."""
        state, ones = self.state(H, v, a, multipliers), np.ones(self.m)
        forces = self.equations.residual(state, ones, np.zeros(self.size))
        none = np.zeros((self.count, 6))
        plan = fl.extend.Plan(none, ones, mass, damping, stressed=H)
        self.equations.fill(state, forces, plan)
        matrix = self.equations.matrix.matrix.copy()  # "convert" changes what it is called on
        return matrix.convert("dense").getDenseArray().copy()

    def differences(self, H, step: float) -> np.ndarray:
        """Central differences of the residual along each unknown of the nodes, column by column."""
        columns = []
        for j in range(6 * self.count):
            h = step * np.eye(1, 6 * self.count, j).reshape(-1, 6)
            ahead, behind = (self.residual(self.moved(H, sign * h)) for sign in (1, -1))
            columns.append((ahead - behind) / (2 * step))
        return np.array(columns).T


def mass_and_stiffness(scene: fl.Scene, modes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mass and stiffness of modes (m, n, 6) of the only body about its initial configuration."""
    of = Assembled(scene, dynamics=True)
    (nodes,) = of.equations.unknowns.bodies.values()
    vectors = np.empty_like(modes)
    vectors[:, nodes] = modes
    assert not vectors[:, of.held].any(), "a mode moves what is held"
    V, K = vectors.reshape(len(modes), -1), of.matrix(of.start)
    M = of.matrix(of.start, mass=1.0) - K
    return V @ M @ V.T, V @ K @ V.T
