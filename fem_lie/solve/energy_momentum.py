"""Energy and momenta to round-off."""

from __future__ import annotations

import logging
import time as clock
from dataclasses import dataclass, field

import numpy as np

from fem_lie import inertia, lie
from fem_lie._jit import Array
from fem_lie.groups import Group
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve import conserving
from fem_lie.solve.cells import Cells, evaluate
from fem_lie.solve.conserving import Model, State, Work
from fem_lie.solve.factors import factorise
from fem_lie.solve.linear import ConvergenceError, DirectSolver, SingularMatrixError
from fem_lie.solve.policies import Automatic, EveryIteration, Policy
from fem_lie.solve.recorder import History
from fem_lie.solve.scheme import ROTATION, failure
from fem_lie.solve.start import accelerations, check_velocities
from fem_lie.system import System
from fem_lie.frames import push

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class EnergyMomentum:
    tolerance: float = 0.0
    policy: Policy = field(default_factory=Automatic)
    max_iterations: int = 50

    def run(self, scene, *, duration, step, save_every=1, progress=None) -> Result:
        steps = round(duration / step)
        system = System(scene, dynamics=True)
        run = Run(self, system, step)
        return run.integrate(History(system.info(), steps, step, save_every, progress))


class Run:
    def __init__(self, options, system, step):
        self.options, self.system, self.h = options, system, float(step)
        n, m = system.count, system.m
        system.kinds = np.full(n, int(Group.R3xSO3))
        self.cells = Cells(system.numbering.assemblies)
        att = system.numbering.attachment
        N = len(att.leader)
        rows = len(system.frames)
        z = np.zeros
        P, M = self.cells.places, self.cells.count
        self.s = State(
            system.frames.copy(), z((n, 4, 3)), system.frames.copy(), z((n, 4, 3)), z((n, 4, 3)),
            z((n, 6)), z((rows, 4, 3)), system.frames.copy(), system.frames.copy(),
            z(m), z(m), z((P, 6)), z((P, 6)), z(M), z(M), z(M), z(M))
        self.w = Work(z((5, N, 4, 3)), z((2, N, 6)), z((n, 6)), z((2, n, 4, 3)), z(m), z((3, 6 * n + m)))
        push(system.frames[:n], system.velocities[:n], self.s.V)
        turns = ~system.table.selection[:, :3].any(axis=1)
        measure = np.concatenate([
            np.tile([1 / system.length] * 3 + [ROTATION] * 3, n),
            np.where(turns, ROTATION, 1 / system.length)])
        self.scale = np.ones(m)
        self.model = Model(self.cells.table, tuple(system.table), tuple(system.inertia),
            (att.leader, att.offset, att.trivial), system.held, measure, self.scale,
            system.conservative.copy(), self.h)
        self.counters, self.numbers = np.zeros(6, dtype=np.int64), np.zeros(7)
        self.factorisations = 0
        self.mass, self.damping = 4 / self.h**2, 2 / self.h
        self.born = 0

    def start(self):
        system, s = self.system, self.s
        check_velocities(system, self.h)
        solver = DirectSolver(system.kkt.matrix, "fem_lie_dynamics_")
        try:
            s.weights[:] = accelerations(system, solver, s.H, system.velocities, 0.0, self.h)[1]
        except ValueError:
            pass
        system.set_time(0.0)
        att = system.numbering.attachment
        frames = att.frames(s.H)
        evaluate(self.cells.table, frames, np.zeros_like(frames), s.F, s.W)
        s.account[:] = s.W
        n = system.count
        z = np.zeros((n, 6))
        system.residual(s.H, z, z, np.zeros(system.m), np.ones(system.m), self.w.r[0])
        s.gap[:] = self.w.r[0][6 * n:]
        self.fill(first=True)
        self.factors = factorise(system.kkt)

    def fill(self, first=False):
        system, s, h = self.system, self.s, self.h
        n = system.count
        H = s.H1.copy()
        R = H[:n, 1:]
        def local(V):
            out = np.empty((n, 6))
            out[:, :3] = np.einsum("nkj,nj->nk", R, V[:, 0])
            L = np.einsum("nkj,naj->nak", R, V[:, 1:])
            out[:, 3:] = 0.5 * np.cross(np.eye(3), L).sum(axis=1)
            return out
        v = local(0.5 * (s.V + s.V1)) if not first else system.velocities[:n]
        a = local((s.V1 - s.V) / h) if not first else np.zeros((n, 6))
        if not first:
            a[:, :3] -= np.cross(v[:, 3:], v[:, :3])
        r = np.empty(system.size)
        vv = np.zeros_like(system.velocities); vv[:n] = v
        system.applied(H, vv, a, s.weights, np.ones(system.m), r)
        system.elastic.reset_stress(H)
        ahead = H.copy()
        if not first:
            ahead[:n] = lie.se3_retract(H[:n], (self.counters[0] - self.born) // 2 * h * v)
        self.born = self.counters[0]
        system.fill_matrix(H, vv, a, s.weights, self.scale, np.zeros((n, 6)), self.mass, self.damping, ahead)
        if first:
            self.scale[:] = system.tangent.constraint_scale(H)
            system.fill_matrix(H, vv, a, s.weights, self.scale, np.zeros((n, 6)), self.mass, self.damping, ahead)

    def integrate(self, history):
        self.start()
        rule = self.options.policy.rule()
        opt = (self.options.tolerance, self.options.max_iterations, rule[0], rule[1])
        model = tuple(self.model); s = tuple(self.s); w = tuple(self.w)
        spin = 1.0
        self.system.choices = self.system.scene.choices.resolve(0.0)
        self.record(history, 0)
        begin = clock.perf_counter()
        with history:
            while self.counters[0] < history.steps:
                goal = min(history.steps, (self.counters[0] // history.every + 1) * history.every)
                code = conserving.run(model, s, w, tuple(self.factors), opt, self.counters, self.numbers, goal)
                if code == conserving.MATRIX:
                    if self.counters[1] == 1:
                        conserving.residual(model, s, w)
                    self.fill()
                    self.factors = factorise(self.system.kkt)
                    self.factorisations += 1
                    self.counters[3] = 0; self.numbers[3] = 0
                elif code == conserving.FAILED:
                    raise ConvergenceError(f"failed {self.counters} {self.numbers}", history.result(0, 0))
                else:
                    self.record(history, self.counters[0])
        return history.result(self.factorisations, clock.perf_counter() - begin)

    def record(self, history, index):
        s, system, n = self.s, self.system, self.system.count
        row = history.row
        att = system.numbering.attachment
        history.frames[row] = att.frames(s.H)
        R = s.H[:n, 1:]
        v = np.empty((n, 6))
        v[:, :3] = np.einsum("nkj,nj->nk", R, s.V[:, 0])
        L = np.einsum("nkj,naj->nak", R, s.V[:, 1:])
        v[:, 3:] = 0.5 * np.cross(np.eye(3), L).sum(axis=1)
        history.velocities[row] = att.twists(v)
        history.joint_forces[row] = system.joint_forces(s.H, s.weights)
        p = np.empty_like(s.V)
        inertia.multiply(*system.inertia, s.V, p)
        history.invariants[row, 0] = 0.5 * np.sum(p * s.V)
        history.invariants[row, 1:4] = p[:, 0].sum(axis=0)
        history.invariants[row, 4:] = np.cross(s.H[:n], p).sum(axis=(0, 1))
        history.elastic[row] = s.W.sum()
        history.potential[row] = -np.sum(system.conservative * s.H[:n])
        history.times[row], history.iterations[row] = index * self.h, self.counters[2]
        history.row += 1
