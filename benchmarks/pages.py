"""Pages that move: how large they are, how long they take to write, how fast a browser draws them.

- pendulum: 2 × 10 beams, 500 states
- hemisphere: a quarter, 32 × 32 cells, 60 load steps, in colours
- truss: 56 bars of 10 elements, 300 states

Drawn by headless Chromium without a graphics card, at 1300 × 800 pixels: the time that a state
takes, pictures per second, and the requests that the page made. ``--keep FOLDER`` leaves them.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import fem_lie as fl
from demos import double_pendulum, hemisphere, truss_deployment

TIMED = """
<script>
const slider = document.getElementById("slider");
const gl = document.querySelector("#stage canvas").getContext("webgl2");
const pixel = new Uint8Array(4);
const move = (k) => {
  slider.value = slider.max * (k % 37) / 37;
  slider.dispatchEvent(new Event("input"));
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
};
for (let k = 0; k < 5; k++) move(k);
const before = performance.now();
for (let k = 0; k < 60; k++) move(k);
const report = document.createElement("pre");
report.id = "report";
report.textContent = JSON.stringify({
  ms_per_state: (performance.now() - before) / 60,
  requests: performance.getEntriesByType("resource").length,
});
document.body.append(report);
</script>
"""


def pendulum() -> fl.post.Page:
    """Case 2 for 0.5 s."""
    scene, _, _ = double_pendulum.pendulum(2)
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, step=double_pendulum.STEP[2], duration=0.5)
    return result.page(states=500, trace=["bar II.end"], title="Double pendulum")


def hemisphere_in_colours() -> fl.post.Page:
    """R/t = 250, 60 steps of the load."""
    scene = hemisphere.pinched(0.04, hemisphere.quarter(32))
    result = fl.statics(scene, load_steps=60)
    shell = scene.bodies[0]
    assert isinstance(shell, fl.Shell)
    colours = fl.post.resultant_colours(fl.post.resultant_series(result, shell), "von Mises top")
    trace = ["hemisphere.00", "hemisphere.10"]
    return result.page(colours=[colours], trace=trace, title="Pinched hemisphere")


def truss() -> fl.post.Page:
    """Two cells, thin tubes, the whole deployment."""
    section = fl.Section.tube(0.024, 0.025, truss_deployment.STEEL)
    scene = truss_deployment.Truss(2, section, 10, 1, fl.schemes.MatrixTerms()).scene
    result = fl.GeneralisedAlpha(radius=0.8).run(
        scene, duration=truss_deployment.DEPLOYMENT, step=2e-2
    )
    return result.page(states=300, title="Deployable truss")


SCENES: dict[str, Callable[[], fl.post.Page]] = {
    "pendulum": pendulum,
    "hemisphere": hemisphere_in_colours,
    "truss": truss,
}


def drawn(page: fl.post.Page, folder: Path) -> dict[str, float]:
    """What headless Chromium says of a page."""
    browser = shutil.which("chromium")
    if browser is None:
        raise SystemExit("chromium is not installed")
    file = folder / "timed.html"
    file.write_text(page.text.replace("</body>", TIMED + "</body>"), encoding="utf-8")
    flags = [
        "--headless=new",
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--window-size=1300,800",
        f"--user-data-dir={folder / 'profile'}",
        "--dump-dom",
    ]
    shown = subprocess.run(
        [browser, *flags, file.as_uri()], capture_output=True, text=True, check=True, timeout=300
    ).stdout
    found = re.search(r'<pre id="report">(.*?)</pre>', shown)
    if found is None:
        raise SystemExit("the browser said nothing of the page")
    reported: dict[str, float] = json.loads(found.group(1))
    return reported


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="leave the pages there")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures there")
    options = parser.parse_args()
    figures = {}
    print("scene           MB  seconds  ms per state  per second  requests")
    for name, scene in SCENES.items():
        start = perf_counter()
        page = scene()
        seconds = perf_counter() - start
        with tempfile.TemporaryDirectory() as folder:
            reported = drawn(page, Path(folder))
        size = len(page.text.encode()) / 1e6
        figures[name] = {"megabytes": size, **reported}
        print(
            f"{name:12} {size:5.2f} {seconds:8.1f} {reported['ms_per_state']:13.1f}"
            f" {1e3 / reported['ms_per_state']:11.0f} {reported['requests']:9}"
        )
        if options.keep:
            options.keep.mkdir(parents=True, exist_ok=True)
            (options.keep / f"{name}.html").write_text(page.text, encoding="utf-8")
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
