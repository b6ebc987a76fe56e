"""A contact surface with a gap function: what is inside an ellipsoid-like, twisted quartic."""

import math

from fem_lie.extend import GAP_SIGNATURE, GapSurface, callback, compiled, evaluate


@compiled
def within_quartic(X, parameters):
    """Of no symmetry, so that no derivative vanishes."""
    x, y, z = X
    size, bend = parameters
    u, v = x + bend * y * z, y - bend * x * x
    return size - math.sqrt(0.1 + u * u + 1.3 * v * v + 0.8 * z * z + bend * u * v)


@callback(GAP_SIGNATURE)
def quartic_gap(out, X, parameters):
    """The same with its derivatives."""
    evaluate(within_quartic, (0.0, 0.0), out, X, parameters)


class Quartic(GapSurface):
    """The inside of the quartic, fixed to a point."""

    gap = quartic_gap

    def __init__(self, point, size=0.5, bend=0.3):
        """Of a size, bent so much."""
        self.point, self.parameters = point, (size, bend)
