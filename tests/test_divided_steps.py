"""Steps that have no solution are made of smaller ones, in schemes that are made of others, too."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.hamel import rolling
from fem_lie.solve.composed import stages
from fem_lie.solve.composed.momentum_parts import MomentumPart
from fem_lie.solve.composed.run import ComposedRun
from tests.test_composed import driven, rigid_pendulum
from tests.test_coupled_impacts import bouncing_beam
from tests.test_multi_rate import chain, pushed
from tests.test_resume import same, stopped

COMPOSED = {"mean": fl.Composed(), "momenta": fl.Composed(fl.Variational())}


def fail_in_full(monkeypatch, h: float) -> None:
    """Let every composed step of size ``h`` but the first fail when half of its parts are made."""
    one_part, make = ComposedRun._one_part, MomentumPart.make

    def fails(self: ComposedRun) -> bool:
        middle = self._place[stages.PART] == len(self._order) // 2
        whole = self.division.level == 0 and self.index > 0
        return not (whole and middle) and one_part(self)

    def makes(self: MomentumPart, start: float, last: float, earlier: float) -> bool:
        whole = min(abs(self.h / h - part) for part in fl.FiveStages().parts) < 1e-9
        return not (whole and start > 1.2 * h and start / h % 1.0 > 0.2) and make(
            self, start, last, earlier
        )

    monkeypatch.setattr(ComposedRun, "_quick", False)
    monkeypatch.setattr(ComposedRun, "_one_part", fails)
    monkeypatch.setattr(MomentumPart, "make", makes)


@pytest.mark.parametrize("scheme", COMPOSED.values(), ids=COMPOSED)
@pytest.mark.parametrize("scene", [rigid_pendulum, driven], ids=["free", "driven"])
def test_composed_steps_keep_their_order_in_parts(monkeypatch, scheme, scene):
    """They are composed steps of half the size, and so is the motion."""
    duration, h = 0.06, 4e-3
    whole, half = (scheme.run(scene(), duration=duration, step=step) for step in (h, h / 2))
    fail_in_full(monkeypatch, h)
    found = scheme.run(scene(), duration=duration, step=h, save_every=1)
    assert found.divided == len(found.times) - 2
    for name in ("frames", "velocities"):
        exact = getattr(half, name)[::2]
        far, near = (np.abs(getattr(each, name) - exact).max() for each in (whole, found))
        assert near < 0.2 * far
    assert found.joint_violations.max() <= 1e-12


def bouncing() -> tuple[fl.Scene, fl.Body]:
    """A beam whose nodes meet the floor one after the other."""
    scene = bouncing_beam()
    return scene, scene.bodies[0]


DIVIDED = {
    "composed": (lambda two: COMPOSED["mean"], pushed, 2e-2, 10, 1e-11),
    # their energy goes up and down
    "composed of momenta": (lambda two: COMPOSED["momenta"], chain, 4e-2, 10, 0.05),
    "multi-rate": (lambda two: fl.MultiRate({two: 3}), pushed, 2e-2, 3, 1e-11),
    "Hamel": (lambda disc: fl.Hamel(), rolling, 0.2, 6, 0.05),
    "impacts": (lambda beam: fl.GeneralisedAlpha(max_iterations=2), bouncing, 2e-3, 50, 1e-4),
}
"""Schemes, scenes, sizes and numbers of steps, and errors of the balance of energy."""


@pytest.mark.parametrize("name", DIVIDED)
def test_steps_without_a_solution_are_divided(tmp_path, monkeypatch, name):
    """These runs had ended: forces change by their size within a step, or bodies turn far."""
    scheme_of, scene_of, h, steps, error = DIVIDED[name]
    scene, body = scene_of()
    scheme, file = scheme_of(body), tmp_path / "run.h5"
    plan = {"duration": steps * h, "step": h}
    result = scheme.run(scene, **plan)
    assert 0 < result.divided <= steps
    np.testing.assert_allclose(result.times, h * np.arange(steps + 1))
    assert result.joint_violations.max(initial=0.0) <= 1e-11
    assert result.balance_error <= error
    if result.contacts is not None:
        assert result.contacts.penetration.max() <= 1e-11
        assert np.diff(result.total_energy).max() <= 1e-12 * result.total_energy[0]
    stopped(monkeypatch, scheme, scene, file, steps - 1, **plan)
    same(scheme.resume(scene, file), result)
