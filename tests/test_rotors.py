"""Whirl of shafts with discs, and modes that a method of solution has wrong."""

import re
from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.rotors import Rotor, continuous, dense
from fem_lie.linear.spectra import smallest
from fem_lie.linear.spectra.krylov import Approximation, Krylov
from fem_lie.scene.rotation import Rotation

DAMPING = fl.sections.Damping(stiffness=1e-6)


def whirl(rotor: Rotor, speed: float, count: int = 6) -> tuple[fl.stability.Modes, float]:
    """Modes at ``speed`` times the first critical speed, and the spin."""
    spin = speed * rotor.critical()
    return fl.vibrations(rotor.scene(), count, spin=(spin, 0.0, 0.0)), spin


def errors(found: np.ndarray, expected: np.ndarray, spin: float) -> np.ndarray:
    return np.abs(found - expected) / np.maximum(np.abs(expected), spin)


@pytest.mark.parametrize("speed", [0.0, 1.0, 3.0])
@pytest.mark.parametrize("ratio", [1e-3, 1.0])
@pytest.mark.parametrize(
    ("body", "cells", "first", "all_six"),
    [
        ("beam", 4, 2e-5, 2e-2),
        ("beam", 16, 1e-6, 1e-4),
        ("beam", 64, 1e-7, 2e-5),
        ("rod", 16, 1e-6, 1e-4),
    ],
)
def test_whirl_is_that_of_the_continuous_shaft(body, cells, first, all_six, ratio, speed):
    rotor = Rotor(ratio, cells, body)
    modes, spin = whirl(rotor, speed)
    found = errors(modes.frequencies, continuous(rotor, spin, 6)[0], spin)
    assert found[0] < first
    assert found.max() < all_six
    assert np.abs(modes.eigenvalues.real).max() < 1e-9 * max(spin, modes.frequencies[0])
    assert modes.residuals.max() < 1e-6


@pytest.mark.parametrize("speed", [0.5, 3.0])
@pytest.mark.parametrize("bearing", [None, 1e2, 1e5, 1e8])
@pytest.mark.parametrize("damping", [None, DAMPING], ids=["elastic", "damped"])
def test_whirl_is_that_of_a_dense_method(bearing, damping, speed):
    """On springs the shaft can twist and move along its axis, which is no vibration."""
    rotor = Rotor(0.05, 6, "beam", bearing, damping)
    modes, spin = whirl(rotor, speed)
    axis = Rotation.of((spin, 0.0, 0.0), (0.0, 0.0, 0.0))
    pencil = fl.extend.Equations(rotor.scene(), dynamics=True).small_motions(axis).pencil()
    least = 0.02 * rotor.critical()
    found = modes.eigenvalues[np.abs(modes.eigenvalues) > least]
    expected = dense(pencil, 6, least)[: len(found)]
    assert len(found) >= 2
    assert errors(found, expected, spin).max() < 1e-8
    if bearing is not None:
        assert np.count_nonzero(modes.eigenvalues == 0.0) == 2


def test_a_free_motion_that_mass_damping_slows_down_is_no_zero():
    """Displacement along the axis: zero, and minus c/m of shaft and disc together."""
    rotor = Rotor(0.05, 6, "beam", 1e5, fl.sections.Damping(mass=0.3))
    modes, _ = whirl(rotor, 0.0)
    expected = -0.3 * 0.05 / 1.05
    assert np.abs(modes.eigenvalues / expected - 1).min() < 1e-9


@pytest.mark.parametrize("speed", [0.0, 0.7])
@pytest.mark.parametrize("bearing", [1e7, 1e9])
def test_motions_on_stiff_springs_are_not_counted_twice(bearing, speed):
    """A shaft on stiff springs has the two free motions and those of one with supports."""
    modes, spin = whirl(Rotor(0.2, 6, "beam", bearing), speed)
    least = 1e-3 * modes.frequencies.max()
    axis = Rotation.of((spin, 0.0, 0.0), (0.0, 0.0, 0.0))
    scene = Rotor(0.2, 6, "beam", bearing).scene()
    pencil = fl.extend.Equations(scene, dynamics=True).small_motions(axis).pencil()
    found = modes.eigenvalues[2:]
    assert (modes.eigenvalues[:2] == 0.0).all()
    assert errors(found, dense(pencil, 6, least)[:4], spin).max() < 1e-8


@pytest.mark.parametrize("cells", [8, 64])
@pytest.mark.parametrize(
    "rotor", [Rotor(0.01, 8), Rotor(0.3, 8, "rod"), Rotor(0.2, 8, "beam", 1e3)]
)
def test_fewer_modes_are_the_same(rotor, cells):
    rotor = replace(rotor, cells=cells)
    many, spin = whirl(rotor, 1.7)
    for count in (1, 5):
        few, _ = whirl(rotor, 1.7, count)
        np.testing.assert_allclose(
            few.eigenvalues, many.eigenvalues[:count], atol=1e-9 * max(spin, 1.0)
        )


# --- modes that a method of solution has wrong ---


def spoiled(monkeypatch: pytest.MonkeyPatch, method: str, how) -> None:
    """Change what a method of solution returns."""
    full = Krylov.__call__ if method == "krylov" else smallest.dense

    def changed(*arguments):
        found = full(*arguments)
        return Approximation(*how(found.s.copy(), found.vectors.copy()), found.solve)

    if method == "krylov":
        monkeypatch.setattr(Krylov, "__call__", changed)
    else:
        monkeypatch.setattr(smallest, "dense", changed)


def wrong_vector(s, vectors):
    """Vectors of the slowest modes with a part that is none of theirs."""
    slow = np.argsort(np.abs(s))[:4]
    vectors[slow] += 0.01 * np.linalg.norm(vectors[slow[0]]) / np.sqrt(vectors.shape[1])
    return s, vectors


def too_few(s, vectors):
    """The slowest of all are missing."""
    return s[:1], vectors[:1]


@pytest.mark.parametrize("how", [wrong_vector, too_few])
@pytest.mark.parametrize("speed", [0.0, 0.7])
def test_modes_that_krylov_methods_have_wrong_are_computed_again(monkeypatch, how, speed):
    rotor = Rotor(0.2, 8)
    expected, spin = whirl(rotor, speed)
    spoiled(monkeypatch, "krylov", how)
    found = fl.vibrations(rotor.scene(), 6, spin=(spin, 0.0, 0.0))
    np.testing.assert_allclose(found.eigenvalues, expected.eigenvalues, atol=1e-8 * 100.0)
    assert found.residuals.max() < 1e-6


@pytest.mark.parametrize("how", [wrong_vector, too_few])
@pytest.mark.parametrize("speed", [0.0, 0.7])
def test_modes_that_all_methods_have_wrong_are_refused(monkeypatch, how, speed):
    rotor = Rotor(0.2, 8)
    spin = speed * rotor.critical()
    spoiled(monkeypatch, "krylov", how)
    spoiled(monkeypatch, "dense", how)
    message = re.escape("6 modes with residuals below 1e-05 were not found: ")
    with pytest.raises(fl.ConvergenceError, match=message):
        fl.vibrations(rotor.scene(), 6, spin=(spin, 0.0, 0.0))


@pytest.mark.parametrize("speed", [0.0, 0.7])
def test_the_dense_method_has_the_modes_of_krylov_methods(speed):
    """Also those of free motions, and with constraints."""
    for rotor in (Rotor(0.2, 6), Rotor(0.2, 6, "beam", 1e4, DAMPING)):
        spin = speed * rotor.critical()
        axis = Rotation.of((spin, 0.0, 0.0), (0.0, 0.0, 0.0))
        pencil = fl.extend.Equations(rotor.scene(), dynamics=True).small_motions(axis).pencil()
        found = [
            smallest._physical(pencil, method(pencil, 6, spin))
            for method in (Krylov("test_"), smallest.dense)
        ]
        rates = [np.where(np.abs(s) <= noise, 0.0, s) for s, _, noise, _ in found]
        first, second = (s[np.argsort(np.abs(s))][:6] for s in rates)
        np.testing.assert_allclose(first, second, rtol=1e-6, atol=1e-7 * np.abs(first).max())
