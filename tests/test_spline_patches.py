"""Patches of splines: the surface they are given, whatever their knots, and bad input."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import BSpline

import fem_lie as fl
from tests.hermite_functions import bicubic

SECTION = fl.ShellSection.layer(0.01, fl.Material(1e7, 0.3, 1e3))
A = np.array([0, 0, 0, 0, 0.3, 0.3, 1, 1, 1, 1.0])
B = np.array([0, 0, 0, 0, 0.4, 1.5, 2, 2, 2, 2.0])
"""One inner knot doubled; two single ones."""


def controls() -> np.ndarray:
    """Of a crooked surface."""
    x, y = np.meshgrid(np.linspace(0, 2, len(A) - 4), np.linspace(0, 1, len(B) - 4), indexing="ij")
    noise = np.random.default_rng(3).normal(size=(*x.shape, 3))
    return np.stack([x, y, np.sin(x + y)], axis=-1) + 0.02 * noise


def surface(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of the spline at a grid, by SciPy."""
    first = BSpline(A, controls(), 3)(a)
    return BSpline(B, first.swapaxes(0, 1), 3)(b).swapaxes(0, 1)


@pytest.mark.parametrize("pieces", [(1, 1), (2, 3)])
def test_a_spline_is_exactly_the_surface_of_the_shell(pieces):
    """Between the knots, too, and cut into more cells."""
    shell = fl.ThinShell(fl.mesh.bspline_patch(A, B, controls(), pieces=pieces), SECTION)
    cut = [
        np.concatenate([np.linspace(s, t, n + 1)[:-1] for s, t in pairwise(k)])
        for k, n in zip((np.unique(A), np.unique(B)), pieces, strict=True)
    ]
    sizes = [np.diff(np.append(c, k[-1])) for c, k in zip(cut, (A, B), strict=True)]
    ξ, η = 0.3, 0.7
    values = bicubic([[ξ, η]])[0]
    found = np.einsum("a,maj->mj", values, shell.model.hermite_vectors())
    wanted = surface(cut[0] + ξ * sizes[0], cut[1] + η * sizes[1]).reshape(-1, 3)
    np.testing.assert_allclose(found, wanted, atol=1e-14)


def test_a_plate_with_cells_of_different_sizes():
    """Vibrates as one with equal cells: the parameters of both are lengths."""
    means = [np.convolve(k[1:-1], np.ones(3) / 3, mode="valid") for k in (A, B)]
    x, y = np.meshgrid(*means, indexing="ij")
    flat = np.stack([x, y, np.zeros_like(x)], axis=-1)
    patches = (
        fl.mesh.bspline_patch(A, B, flat, pieces=(2, 2)),
        fl.mesh.smooth_patch(lambda a, b: [a, 2 * b, 0], (5, 7)),
    )
    found = []
    for patch in patches:
        shell = fl.ThinShell(patch, SECTION)
        shell.clamp("a=0")
        scene = fl.Scene()
        scene.add(shell)
        found.append(fl.vibrations(scene, 3).frequencies)
    np.testing.assert_allclose(found[0], found[1], rtol=2e-3)


def test_a_spline_through_a_surface_converges_with_order_four():
    def position(a: float, b: float) -> list[float]:
        return [np.sin(a), np.cos(a) + 0.1 * b * b, b + 0.2 * np.sin(a * b)]

    values = bicubic([[0.5, 0.5]])[0]
    errors = []
    for n in (4, 8, 16):
        shell = fl.ThinShell(fl.mesh.spline_patch(position, (n, n)), SECTION)
        middles = (np.arange(n) + 0.5) / n
        wanted = np.array([position(a, b) for a in middles for b in middles])
        errors.append(
            np.abs(np.einsum("a,maj->mj", values, shell.model.hermite_vectors()) - wanted).max()
        )
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 3.7
    assert errors[-1] < 1e-6


def without(knots: np.ndarray, at: int) -> np.ndarray:
    return np.delete(knots, at)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fl.mesh.bspline_patch(A[::-1], B, controls()), "do not decrease"),
        (lambda: fl.mesh.bspline_patch(A[:7], B, controls()), "eight or more"),
        (lambda: fl.mesh.bspline_patch(without(A, 0), B, controls()), "multiplicity four"),
        (
            lambda: fl.mesh.bspline_patch(np.insert(A, 5, 0.3), B, controls()),
            "multiplicity one or two",
        ),
        (
            lambda: fl.mesh.bspline_patch(A, B, controls()[:-1]),
            r"shape \(6, 6, 3\), got \(5, 6, 3\)",
        ),
        (lambda: fl.mesh.bspline_patch(A, B, np.ones((6, 6, 3))), "neither zero nor parallel"),
        (lambda: fl.mesh.bspline_patch(A, B, controls(), pieces=(0, 1)), "pieces along a"),
        (
            lambda: fl.mesh.spline_patch(lambda a, b: [a, b, 0], (0, 1)),
            "cells along a must be at least 1",
        ),
    ],
)
def test_bad_input(make, message):
    with pytest.raises(ValueError, match=message):
        make()
