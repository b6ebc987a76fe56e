r"""Rotations and rigid-body frames: conventions of the package, and operations.

**Frame.** ``H = (R, x)``: position ``x`` and rotation ``R`` of a point; ``R`` maps components
along the point's own axes (local) to components along the fixed axes (global). Stored as 12
numbers of shape ``(4, 3)``: row 0 is ``x``, rows 1-3 are the directors ``R e₁, R e₂, R e₃``, which
are the rows of ``Rᵀ``.

**Six-vectors.** Twists, velocities, increments, virtual displacements, strains ``(u, θ)``, forces
and momenta ``(n, m)``: always (translation, rotation), always in the local frame of their point.

**Increments act from the right.** ``H ← H exp(d)``, velocity ``Ḣ = H v̂`` with ``v = (Rᵀẋ, ω)``,
and the tangent operator is the right Jacobian: ``H⁻¹δH = (T₆(d) δd)^`` for ``H = exp d``, with
``T₆(−d) = Ad(exp d) T₆(d)``.

**Adjoints.** ``Ad(H) = [[R, x̂R], [0, R]]`` takes a twist out of the frame H, ``Ad⁻ᵀ(H)`` a force,
and the power ``f·v`` is invariant. ``ad(v) = [[ω̂, û], [0, ω̂]]``.

======================  =========================================  ===========================
symbol                  one point, compiled, in place              arrays of points
======================  =========================================  ===========================
exp d                   exp_se3                                    se3_exp
log H, \|θ\| ≤ π        log_se3                                    se3_log
H exp(d)                retract                                    se3_retract
log(A⁻¹B)               relative                                   se3_relative
A B, H⁻¹                compose, inverse                           se3_compose, se3_inverse
R ← R(3I − RᵀR)/2       reorthonormalise
T₆(d)                   tangent                                    se3_tangent
T₆(d) v, T₆ᵀ(d) f       apply_tangent[_transposed]
T₆⁻¹(±d)                tangent_inverse[_minus]                    se3_tangent_inverse
T₆⁻¹(±d) v              apply_tangent_inverse[_minus]
T₆⁻ᵀ(±d) f              apply_tangent_inverse_transposed[_minus]
∂(T₆⁻ᵀ(δ) f)/∂δ, δ=±d   tangent_inverse_transposed_derivative      as left, with ``se3_`` before
                        and …_minus
Ad(H)                   adjoint                                    se3_adjoint
Ad^{1,−1,ᵀ,−ᵀ}(H) v     apply_adjoint[_inverse][_transposed]
ad(v), ad(v)ᵀ           apply_ad, apply_ad_transposed              se3_ad
P(p): ad(v)ᵀp = P v     coadjoint_matrix                           se3_coadjoint
exp θ̂, log R            exp_so3, log_so3                           so3_exp, so3_log
T, T⁻¹                  tangent[_inverse]_so3                      so3_tangent[_inverse]
T w, Tᵀw, T⁻¹w, T⁻ᵀw    apply_tangent[_inverse][_transposed]_so3
∂(T w)/∂θ, ∂(T⁻¹w)/∂θ   tangent[_inverse]_derivative_so3           so3_tangent[_inverse]_derivative
cay ψ                   cayley_so3                                 so3_cayley
its T, T⁻¹              cayley_tangent[_inverse]_so3               so3_cayley_tangent
cay d, its T₆           cayley_se3, cayley_tangent_se3             se3_cayley, se3_cayley_tangent
======================  =========================================  ===========================

Functions of the second column are for compiled loops: the result is the last argument, may be any
view, may be an input, and nothing is allocated. Those of the third accept array-like arguments
with any leading dimensions, broadcast them and return new arrays; rotations are matrices ``R``,
not directors. All are accurate to round-off at every angle; ``T⁻¹`` is singular at 2π.

Sources: G. S. Chirikjian, *Stochastic Models, Information Theory, and Lie Groups* 2 (2012), ch. 10;
V. Sonneville, A. Cardona & O. Brüls, *CMAME* 268 (2014) 451, doi:10.1016/j.cma.2013.10.008;
A. Müller, *Proc. R. Soc. A* 477 (2021) 20210303, doi:10.1098/rspa.2021.0303.
"""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.lie.adjoints import (
        adjoint,
        apply_ad,
        apply_ad_transposed,
        apply_adjoint,
        apply_adjoint_inverse,
        apply_adjoint_inverse_transposed,
        apply_adjoint_transposed,
        coadjoint_matrix,
    )
    from fem_lie.lie.batched import (
        FRAME,
        MATRIX,
        TWIST,
        VECTOR,
        frame,
        hat,
        homogeneous,
        position,
        rotation,
        se3_ad,
        se3_adjoint,
        se3_cayley,
        se3_cayley_tangent,
        se3_coadjoint,
        se3_compose,
        se3_exp,
        se3_inverse,
        se3_log,
        se3_relative,
        se3_retract,
        se3_tangent,
        se3_tangent_inverse,
        se3_tangent_inverse_transposed_derivative,
        so3_cayley,
        so3_cayley_tangent,
        so3_exp,
        so3_log,
        so3_tangent,
        so3_tangent_derivative,
        so3_tangent_inverse,
        so3_tangent_inverse_derivative,
        vee,
    )
    from fem_lie.lie.motions import Group, Parametrisation
    from fem_lie.lie.se3 import (
        apply_tangent,
        apply_tangent_inverse,
        apply_tangent_inverse_minus,
        apply_tangent_inverse_transposed,
        apply_tangent_inverse_transposed_minus,
        apply_tangent_transposed,
        cayley_se3,
        cayley_tangent_se3,
        compose,
        exp_se3,
        inverse,
        log_se3,
        relative,
        reorthonormalise,
        retract,
        tangent,
        tangent_inverse,
        tangent_inverse_minus,
        tangent_inverse_transposed_derivative,
        tangent_inverse_transposed_derivative_minus,
    )
    from fem_lie.lie.so3 import (
        apply_tangent_inverse_so3,
        apply_tangent_inverse_transposed_so3,
        apply_tangent_so3,
        apply_tangent_transposed_so3,
        cayley_so3,
        cayley_tangent_inverse_so3,
        cayley_tangent_so3,
        exp_so3,
        log_so3,
        tangent_derivative_so3,
        tangent_inverse_derivative_so3,
        tangent_inverse_so3,
        tangent_so3,
    )
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "FRAME",
    "MATRIX",
    "TWIST",
    "VECTOR",
    "Group",
    "Parametrisation",
    "adjoint",
    "apply_ad",
    "apply_ad_transposed",
    "apply_adjoint",
    "apply_adjoint_inverse",
    "apply_adjoint_inverse_transposed",
    "apply_adjoint_transposed",
    "apply_tangent",
    "apply_tangent_inverse",
    "apply_tangent_inverse_minus",
    "apply_tangent_inverse_so3",
    "apply_tangent_inverse_transposed",
    "apply_tangent_inverse_transposed_minus",
    "apply_tangent_inverse_transposed_so3",
    "apply_tangent_so3",
    "apply_tangent_transposed",
    "apply_tangent_transposed_so3",
    "cayley_se3",
    "cayley_so3",
    "cayley_tangent_inverse_so3",
    "cayley_tangent_se3",
    "cayley_tangent_so3",
    "coadjoint_matrix",
    "compose",
    "exp_se3",
    "exp_so3",
    "frame",
    "hat",
    "homogeneous",
    "inverse",
    "log_se3",
    "log_so3",
    "position",
    "relative",
    "reorthonormalise",
    "retract",
    "rotation",
    "se3_ad",
    "se3_adjoint",
    "se3_cayley",
    "se3_cayley_tangent",
    "se3_coadjoint",
    "se3_compose",
    "se3_exp",
    "se3_inverse",
    "se3_log",
    "se3_relative",
    "se3_retract",
    "se3_tangent",
    "se3_tangent_inverse",
    "se3_tangent_inverse_transposed_derivative",
    "so3_cayley",
    "so3_cayley_tangent",
    "so3_exp",
    "so3_log",
    "so3_tangent",
    "so3_tangent_derivative",
    "so3_tangent_inverse",
    "so3_tangent_inverse_derivative",
    "tangent",
    "tangent_derivative_so3",
    "tangent_inverse",
    "tangent_inverse_derivative_so3",
    "tangent_inverse_minus",
    "tangent_inverse_so3",
    "tangent_inverse_transposed_derivative",
    "tangent_inverse_transposed_derivative_minus",
    "tangent_so3",
    "vee",
]
