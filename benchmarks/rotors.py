"""Whirl of a shaft with a disc at its free end, in the frame that turns with it.

    python -m benchmarks.rotors [--cells 4 8 16 32 64] [--ratios 1e-3 1e-2 0.2 1] [--bodies rod]

Steel, 20 mm x 0.4 m, clamped or on springs, with 6 modes for spins of 0 to 3 times the first
critical speed. Errors are those of eigenvalues over the spin, or their absolute value if that is
larger: "dense" from a dense, scaled QZ of the same matrices, or the QR algorithm for the inverse of
those beyond 800 rows, refined by Newton's method in extended precision; "first" and "resolved" from
the transfer matrix of the continuous shaft, of the slowest mode and of all modes that have at least
16 elements to a half-wave of bending, twist or extension.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from time import perf_counter

import numpy as np
import numpy.typing as npt
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg
from scipy.optimize import brentq, linear_sum_assignment

import fem_lie as fl
from demos.reference.whirling_shaft import roots
from fem_lie.linear.spectra.pencil import Pencil
from fem_lie.scene.rotation import Rotation
from fem_lie.system.equations import Equations

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

STEEL = fl.Material(2.1e11, 0.3, 7800.0)
LENGTH, RADIUS, DISC = 0.4, 0.01, 0.08
SPEEDS = (0.0, 0.5, 1.0, 1.7, 3.0)
COUNT, FINE = 6, 16
BESIDE = 1e-7
LARGE = 800
"""Rows beyond which QZ takes minutes: 3 s for 768, QR 8 s for 2400."""


@dataclass(frozen=True)
class Rotor:
    """A shaft along x with a disc at its free end.

    Attributes:
        ratio: Mass of the shaft over that of the disc.
        cells: Number of elements.
        body: "beam" or "rod".
        bearing: Stiffness of springs along y and z at both ends, N/m; ``None``: clamped at x = 0.
        damping: Of the shaft.
    """

    ratio: float
    cells: int
    body: str = "beam"
    bearing: float | None = None
    damping: fl.sections.Damping | None = None

    @property
    def section(self) -> fl.Section:
        """Cross-section of the shaft."""
        return fl.Section.circle(RADIUS, STEEL)

    @property
    def disc(self) -> tuple[float, float, float]:
        """Mass of the disc, and its moments of inertia about its axis and a diameter."""
        mass = STEEL.density * np.pi * RADIUS**2 * LENGTH / self.ratio
        return mass, mass * DISC**2 / 2, mass * DISC**2 / 4

    def scene(self) -> fl.Scene:
        """The rotor at rest."""
        kind = {"beam": fl.Beam, "rod": fl.Rod}[self.body]
        options = {} if self.damping is None else {"damping": self.damping}
        ends = (0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0)
        shaft = kind.straight(*ends, self.section, cells=self.cells, **options)
        mass, polar, across = self.disc
        disc = fl.RigidBody(mass, (polar, across, across), position=ends[1])
        scene = fl.Scene()
        scene.add(shaft)
        scene.add(disc)
        scene.add(fl.joints.RigidLink(shaft.point("end"), disc.point("centre")))
        if self.bearing is None:
            scene.add(fl.Clamp(shaft.point("start")))
            return scene
        for end, axis in product((shaft.point("start"), shaft.point("end")), np.eye(3)[1:]):
            joint = scene.add(fl.joints.Distance(fl.ground(), end, at=end.position + axis))
            scene.add(fl.joints.Spring(joint.length, stiffness=self.bearing))
        return scene

    def critical(self) -> float:
        """Its slowest frequency at rest, rad/s."""
        found = fl.vibrations(self.scene(), COUNT).frequencies
        return float(found[found > 1e-6 * found.max()][0])


# --- the same matrices ---


def dense(pencil: Pencil, count: int, least: float) -> Complex:
    """Slowest eigenvalues with ``Im s ≥ 0`` from a size on, by QZ, in extended precision."""
    basis = _admissible(pencil.B)
    C = sp.csr_matrix(pencil.M.shape) if pencil.C is None else pencil.C
    M, C, K = (basis.T @ (A @ basis) for A in (pencil.M, C, pencil.K))
    scale = 1.0 / np.sqrt(np.abs(np.diag(K)))
    M, C, K = (scale[:, np.newaxis] * A * scale for A in (M, C, K))
    unit = np.sqrt(np.linalg.norm(K, 2) / np.linalg.norm(M, 2))
    n = len(M)
    one, none = np.eye(n), np.zeros((n, n))
    A = np.block([[none, one], [-K, -unit * C]])
    s = _spectrum(A, np.block([[one, none], [none, unit**2 * M]]))
    kept = s[np.isfinite(s) & (s.imag >= 0.0) & (np.abs(s) >= least / unit)]
    slowest = unit * kept[np.argsort(np.abs(kept))][: count + 4]
    return np.array([_newton(pencil, z) for z in slowest])


def _spectrum(A: Array, B: Array) -> Complex:
    """All ``s`` with ``A z = s B z``; the slowest are the largest of the inverse."""
    if len(A) <= LARGE:
        return np.asarray(scipy.linalg.eigvals(A, B))
    return np.asarray(1.0 / scipy.linalg.eigvals(np.linalg.solve(A, B)))


def _admissible(B: sp.csr_matrix) -> Array:
    """Orthonormal columns that satisfy the constraints."""
    return np.eye(B.shape[1]) if not B.shape[0] else scipy.linalg.null_space(B.toarray())


def _newton(pencil: Pencil, s: complex) -> complex:
    """Newton's method for ``Q(s) φ + Bᵀ μ = 0``, ``B φ = 0`` and ``wᵀ φ = 1``.

    It starts from two steps of inverse iteration beside ``s``. Products are those of the pencil,
    whose stiffness has no round-off in rigid motion: sums of stiff elements have some.
    """
    M, K, B = pencil.M, pencil.K, pencil.B * np.abs(pencil.K.diagonal()).mean()
    C = sp.csr_matrix(M.shape) if pencil.C is None else pencil.C
    n, m = M.shape[0], B.shape[0]
    saddle_point = [sp.bmat([[A, None], [None, sp.csr_matrix((m, m))]]) for A in (M, C)]
    saddle_point.append(sp.bmat([[K, B.T], [B, None]]) if m else K)
    beside = s * (1.0 + BESIDE)
    near = beside**2 * saddle_point[0] + beside * saddle_point[1] + saddle_point[2]
    factors, start = scipy.sparse.linalg.splu(near.tocsc()), np.zeros(n + m, dtype=np.complex128)
    start[:n] = np.random.default_rng(0).normal(size=n)
    for _ in range(2):
        start = factors.solve(start)
        start[n:] = 0.0
        start /= np.linalg.norm(start)
    x, w = start.astype(np.clongdouble), start.conj()
    wide, value = B.astype(np.longdouble), np.clongdouble(s)
    for _ in range(6):
        products = pencil.terms(x[np.newaxis, :n])
        inertia, damping, stiff = (np.append(term[0], np.zeros(m)) for term in products)
        stiff[:n] += wide.T @ x[n:].real + 1j * (wide.T @ x[n:].imag)
        stiff[n:] = wide @ x[:n].real + 1j * (wide @ x[:n].imag)
        r = value * value * inertia + value * damping + stiff
        slope = np.asarray(2 * value * inertia + damping, dtype=np.complex128)
        z = complex(value)
        Q = z * z * saddle_point[0] + z * saddle_point[1] + saddle_point[2]
        J = sp.bmat([[Q, slope[:, np.newaxis]], [w[np.newaxis], None]], format="csc")
        right = np.append(r, (w * x).sum() - 1.0).astype(np.complex128)
        change = scipy.sparse.linalg.splu(J).solve(right)
        x, value = x - change[:-1], value - change[-1]
    return complex(value)


# --- the continuous shaft ---


def continuous(rotor: Rotor, spin: float, count: int) -> tuple[Array, Array]:
    """Slowest frequencies of the clamped rotor in the turning frame, and their half-waves.

    A circular shaft with shear and rotary inertia whirls as ``w exp(iλt)``, ``w = y + iz``, in
    space, which is a frequency ``|λ - Ω|`` in the frame that turns; twist and extension are the
    same in both. (R. Eshleman & R. Eubanks, J. Eng. Ind. 91 (1969) 1180.)
    """
    D, inertia = np.diag(rotor.section.stiffness), np.diag(rotor.section.inertia)
    whirls = [sign * λ for sign in (1.0, -1.0) for λ in roots(_whirl(rotor, sign * spin), count)]
    mass, polar, _ = rotor.disc
    axial = _waves(D[0], inertia[0], mass, count)
    twist = _waves(D[3], inertia[2] + inertia[3], polar, count)
    found = np.concatenate([np.abs(np.array(whirls) - spin), axial, twist])
    number = np.arange(1, count + 1)
    waves = np.concatenate([number, number, number, number])
    order = np.argsort(found)[:count]
    return found[order], waves[order]


def _whirl(rotor: Rotor, spin: float) -> Callable[[float], float]:
    """The determinant whose positive zeros are those λ that have the sign of the spin."""
    D, inertia = np.diag(rotor.section.stiffness), np.diag(rotor.section.inertia)
    EI, line = D[4], inertia[0]
    # rods have no shear
    soft, rotary = 0.0 if rotor.body == "rod" else 1.0 / D[2], inertia[2]
    mass, polar, across = rotor.disc
    # deflection, slope, moment, shear force
    units = np.array([1.0, 1.0 / LENGTH, EI / LENGTH**2, EI / LENGTH**3])

    def determinant(λ: float) -> float:
        A = np.zeros((4, 4))
        A[0, 1], A[0, 3], A[1, 2] = 1.0, soft, 1.0 / EI
        A[2, 1], A[2, 3] = -rotary * λ**2 + 2.0 * rotary * spin * λ, -1.0
        A[3, 0] = -line * λ**2
        T = scipy.linalg.expm(LENGTH * A * units / units[:, np.newaxis])
        T = T * units[:, np.newaxis] / units
        ends = np.array(
            [[0.0, -(across * λ**2 - polar * spin * λ), 1.0, 0.0], [-mass * λ**2, 0.0, 0.0, 1.0]]
        )
        return float(np.linalg.det(((ends @ T)[:, 2:] * units[2:]) / units[2:, np.newaxis]))

    return determinant


def _waves(stiffness: float, line: float, end: float, count: int) -> Array:
    """Frequencies of a bar with a mass at its end: ``β tan β = line · length/end``."""
    share = line * LENGTH / end
    roots = [
        brentq(lambda b: b * np.sin(b) - share * np.cos(b), k * np.pi, (k + 0.5) * np.pi)
        for k in range(count)
    ]
    return np.array(roots) * np.sqrt(stiffness / line) / LENGTH


# --- the table ---


@dataclass(frozen=True)
class Row:
    """Errors of one rotor, see above."""

    dense: float
    first: float
    resolved: float
    residual: float
    growth: float
    seconds: float

    @classmethod
    def of(cls, rotor: Rotor, speed: float) -> Row:
        """Measure at ``speed`` times the critical speed."""
        critical = rotor.critical()
        spin = speed * critical
        scene = rotor.scene()
        start = perf_counter()
        modes = fl.vibrations(scene, COUNT, spin=(spin, 0.0, 0.0))
        seconds = perf_counter() - start
        # on springs it can twist and move along its axis: of these double zeros QZ makes numbers
        least = 0.0 if rotor.bearing is None else 1e-2 * critical
        found = modes.eigenvalues[np.abs(modes.eigenvalues) >= least]
        axis = Rotation.of((spin, 0.0, 0.0), (0.0, 0.0, 0.0))
        pencil = Equations(scene, dynamics=True).small_motions(axis).pencil()
        same = dense(pencil, COUNT, least)[: len(found)]
        first = resolved = np.nan
        if rotor.bearing is None and rotor.damping is None:
            exact, waves = continuous(rotor, spin, COUNT)
            errors = np.abs(modes.frequencies - exact) / np.maximum(exact, spin)
            fine = waves * FINE <= rotor.cells
            first, resolved = float(errors[0]), float(errors[fine].max()) if fine.any() else np.nan
        return cls(
            _largest(found, same, spin),
            first,
            resolved,
            float(modes.residuals.max()),
            float(modes.eigenvalues.real.max()),
            seconds,
        )


def _largest(found: Complex, same: Complex, spin: float) -> float:
    """Largest error of eigenvalues from others, one by one."""
    size = np.maximum(np.abs(same), spin)
    errors = np.abs(found[:, np.newaxis] - same) / size
    return float(errors[linear_sum_assignment(errors)].max())


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, nargs="+", default=[4, 8, 16, 32, 64])
    parser.add_argument("--ratios", type=float, nargs="+", default=[1e-3, 1e-2, 0.2, 1.0])
    parser.add_argument("--bodies", nargs="+", default=["beam"])
    parser.add_argument("--speeds", type=float, nargs="+", default=SPEEDS)
    parser.add_argument("--bearing", type=float)
    parser.add_argument("--stiffness-damping", type=float)
    options = parser.parse_args()
    damping = options.stiffness_damping and fl.sections.Damping(stiffness=options.stiffness_damping)
    print("body  cells  shaft/disc  speed    dense    first  resolved  residual    growth  seconds")
    for body, cells, ratio in product(options.bodies, options.cells, options.ratios):
        rotor = Rotor(ratio, cells, body, options.bearing, damping)
        for speed in options.speeds:
            row = Row.of(rotor, speed)
            print(
                f"{body:4}  {cells:5}  {ratio:10.3g}  {speed:5.2f}  {row.dense:7.1e}  "
                f"{row.first:7.1e}   {row.resolved:7.1e}   {row.residual:7.1e}  "
                f"{row.growth:8.1e}  {row.seconds:7.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
