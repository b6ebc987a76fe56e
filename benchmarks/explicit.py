"""What explicit steps cost per element, from nets that fit a cache to one of 10⁵ edges.

Nets of wave_in_a_net.py at nine tenths of the largest step. Seconds are those that the processor
had; of two runs of different length the difference counts, so what a run takes to begin does not.
Sizes are taken in turns, again and again, and of each the least counts.

    python -m benchmarks.explicit [--cells 10 40 222] [--repeats 5]
"""

from __future__ import annotations

import argparse
from time import process_time

import fem_lie as fl
from demos.wave_in_a_net import square_net

WORK, WANTED = 4_000_000, 150.0


class Timed:
    """A net, and the seconds of its runs."""

    def __init__(self, cells: int) -> None:
        """Of so many meshes per side."""
        self.scene, net = square_net(cells)
        self.elements, self.scheme = len(net.model.elements), fl.Explicit()
        self.step = 0.9 * self.scheme.stable_step(self.scene)
        self.steps = max(20, WORK // self.elements)
        self.seconds(1)

    def seconds(self, steps: int) -> float:
        """Of a run of so many steps."""
        begin, duration = process_time(), steps * self.step
        self.scheme.run(self.scene, duration=duration, step=self.step, save_every=steps)
        return process_time() - begin

    def each(self) -> float:
        """Nanoseconds per element and step."""
        begun = self.seconds(1)
        return 1e9 * (self.seconds(1 + self.steps) - begun) / (self.steps * self.elements)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, nargs="+", default=[10, 40, 222])
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    nets = [Timed(cells) for cells in options.cells]
    found = [[net.each() for net in nets] for _ in range(options.repeats)]
    print(f"| edges | ns per edge and step (wanted {WANTED:g}) | median |\n|---|---|---|")
    for net, own in zip(nets, zip(*found, strict=True), strict=True):
        ordered = sorted(own)
        print(f"| {net.elements} | {ordered[0]:.0f} | {ordered[len(own) // 2]:.0f} |")


if __name__ == "__main__":
    main()
