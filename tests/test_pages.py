"""Pages that move: what they hold, and that a browser shows it without a network."""

import base64
import hashlib
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import fem_lie as fl

ROOT = Path(__file__).parent.parent
KINDS = {"u1": "u1", "i2": "<i2", "u4": "<u4", "f4": "<f4"}


def pendulum(size=1.0, cells=4):
    """Two bars that fall."""
    strip = fl.Section.rectangle(0.02 * size, 0.02 * size, fl.Material(2e11, 0.3, 7800.0))
    scene = fl.Scene(gravity=(0, 0, -9.81 * size))
    one = scene.add(fl.Beam.straight((0, 0, 0), (size, 0, 0), strip, cells=cells, name="one"))
    two = scene.add(
        fl.Beam.straight((size, 0, 0), (2 * size, 0, 0), strip, cells=cells, name="two")
    )
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=(0, 1, 0)))
    return scene, one, two


@pytest.fixture(scope="module")
def fallen():
    scene, _, _ = pendulum()
    return scene, fl.GeneralisedAlpha().run(scene, step=2e-3, duration=0.4)


def content(page):
    """What the script of a page reads."""
    found = re.search(r'<script id="page" type="application/json">(.*?)</script>', page.text, re.S)
    return json.loads(found.group(1))


def array(packed):
    return np.frombuffer(base64.b64decode(packed["data"]), KINDS[packed["kind"]])


def bent(size):
    """A cantilever under a force at its end, in a unit of length."""
    section = fl.Section.rectangle(0.02 * size, 0.02 * size, fl.Material(2e11, 0.3, 7800.0))
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (size, 0, 0), section, cells=4, name="beam"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 3 * section.stiffness[4, 4] / size**2)))
    return fl.statics(scene, load_steps=3)


@pytest.mark.parametrize("size", [1e-6, 1e3])
def test_units_do_not_matter(size):
    """A scene in other lengths is drawn as the same, but for the numbers at its axes."""
    one, other = (content(bent(s).page(trace=["beam.end"])) for s in (1.0, size))
    positions = [array(shown["bodies"][0]["places"]).astype(int) for shown in (one, other)]
    assert np.abs(positions[0] - positions[1]).max() <= 1
    assert other["unit"] == pytest.approx(one["unit"], rel=1e-6)
    traces = [array(shown["traces"][0]) for shown in (one, other)]
    np.testing.assert_allclose(*traces, atol=1e-5)
    for axis, same in zip(one["axes"], other["axes"], strict=True):
        assert axis["flat"] == same["flat"]
    (diagram,) = other["diagrams"]
    deflection = diagram["curves"][0]["x"]
    assert np.allclose(deflection, size * np.array(one["diagrams"][0]["curves"][0]["x"]), rtol=1e-5)


def test_colours_are_values(fallen):
    """The moment of each state at each corner, to a 255th part of the scale."""
    scene, result = fallen
    colours = [fl.post.section_forces(result, body, scene).colours("My") for body in scene.bodies]
    shown = content(result.page(states=5, colours=colours))
    scale = shown["colours"]
    assert scale["label"] == "My [N m]" and len(scale["names"]) == 256
    rows = result._instants(5)
    largest = max(np.abs(one.values[rows]).max() for one in colours)
    assert float(scale["high"]) == pytest.approx(largest, rel=1e-2)
    for body, one in zip(shown["bodies"], colours, strict=True):
        steps = array(body["values"]).reshape(5, -1).astype(float)
        values = (steps / 255 * 2 - 1) * largest
        for k, row in enumerate(rows):
            assert values[k].min() == pytest.approx(one.values[row].min(), abs=largest / 200)
            assert values[k].max() == pytest.approx(one.values[row].max(), abs=largest / 200)


def test_shells_in_colours():
    """A clamped strip under a force at its end: M11 falls from the clamp to nothing."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.2 * b, 0.0), (8, 2))
    section = fl.ShellSection.layer(0.01, fl.Material(2e11, 0.0, 7800.0))
    shell = fl.Shell(mesh, section, name="strip")
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(0, 0, 10.0)))
    result = fl.statics(scene)
    colours = fl.post.resultant_colours(
        fl.post.resultant_series(result, shell, along=(1, 0, 0)), "M11"
    )
    assert colours.values.shape == result.frames.shape[:2]
    x = shell.frames[:, 0, 0]
    np.testing.assert_allclose(np.abs(colours.values[-1]), 10.0 * (1 - x), atol=0.3)
    assert "values" in content(result.page(colours=[colours]))["bodies"][0]


def column():
    """Clamped below, pressed from above."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.02, fl.Material(2e11, 0.3, 7800.0))
    beam = scene.add(fl.Beam.straight((0, 0, 0), (0, 0, 1), section, cells=4, name="column"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, -100.0)))
    return scene


def test_modes_swing():
    """Out to the amplitude, back through the middle and to the other side."""
    modes, buckles = fl.vibrations(column(), 2), fl.buckling(column(), 1)
    for shown in map(content, (modes.page(2), buckles.page(1))):
        (body,) = shown["bodies"]
        x = array(body["places"]).reshape(len(shown["states"]), -1).astype(float)
        assert shown["states"][0] == 0.0 and shown["states"][-1] == 360.0
        quarter = len(x) // 4
        np.testing.assert_allclose(x[0], x[-1], atol=1.0)
        out, back = x[quarter] - x[0], x[2 * quarter] - x[0]
        assert max(np.abs(out).max(), np.abs(back).max()) > 1000
        assert shown["plays"]
        values = array(body["values"]).reshape(len(x), -1)
        assert (values == values[0]).all() and {values.min(), values.max()} == {0, 255}
        assert shown["colours"]["label"] == "displacement / largest"


def test_a_title_cannot_end_the_script():
    shown = bent(1.0).page(title="</script><b>&", trace=["beam.end"])
    assert "<title>&lt;/script&gt;&lt;b&gt;&amp;</title>" in shown.text
    assert shown.text.count("</script>") == 2
    assert "&lt;/script&amp;gt" in shown._repr_html_() or "&amp;lt;/script" in shown._repr_html_()


@pytest.mark.parametrize(
    "wrong, message",
    [
        (lambda result: result.page("motion.htm"), "must end in '.html'"),
        (lambda result: result.page(seconds=0.0), "seconds must be positive"),
        (lambda result: result.page(states=0), "states"),
        (lambda result: result.page(trace=["nobody.end"]), "nobody"),
        (
            lambda result: result.page(
                colours=[fl.post.NodalColours("one", np.zeros((3, 5)), "N [N]")]
            ),
            "of 3 states, the result has 201",
        ),
        (
            lambda result: result.page(
                colours=[fl.post.NodalColours("one", np.zeros((201, 4)), "N [N]")]
            ),
            r"\(states, nodes\)",
        ),
        (
            lambda result: result.page(
                colours=[
                    fl.post.NodalColours(name, np.zeros((201, 5)), label)
                    for name, label in (("one", "N [N]"), ("two", "T [N m]"))
                ]
            ),
            "expected one quantity for the colours",
        ),
    ],
)
def test_bad_input(fallen, wrong, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=message):
        wrong(fallen[1])
    assert not list(tmp_path.iterdir())


def test_the_script_is_made_of_its_sources(fallen):
    """tools/viewer/build was run after the last change."""
    viewer = ROOT / "tools" / "viewer"
    sources = [viewer / "package-lock.json", *sorted((viewer / "src").glob("*.js"))]
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()
    assert digest in fallen[1].page().text


BROWSER = shutil.which("chromium")
LOOK = """
<script>
const canvas = document.querySelector("#stage canvas");
const errors = [];
addEventListener("error", (event) => errors.push(String(event.message)));
const picture = () => {
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const context = copy.getContext("2d");
  context.drawImage(canvas, 0, 0);
  return context.getImageData(0, 0, copy.width, copy.height).data;
};
const colours = (data) => {
  const found = [0, 0];
  for (let i = 0; i < data.length; i += 4) {
    const [r, g, b] = data.slice(i, i + 3);
    if (b > r + 60) found[0]++;
    if (r > b + 60) found[1]++;
  }
  return found;
};
const move = (part) => {
  const slider = document.getElementById("slider");
  slider.value = part * slider.max;
  slider.dispatchEvent(new Event("input"));
  return picture();
};
const [first, last, again] = [0, 1, 0].map(move);
const same = (a, b) => a.every((value, i) => value === b[i]);
const report = document.createElement("pre");
report.id = "report";
report.textContent = JSON.stringify({
  colours: colours(first),
  moved: !same(first, last),
  back: same(first, again),
  state: document.getElementById("state").textContent,
  requests: performance.getEntriesByType("resource").map((entry) => entry.name),
  diagrams: document.querySelectorAll(".diagram canvas").length,
  errors,
});
document.body.append(report);
</script>
"""


@pytest.mark.skipif(BROWSER is None, reason="no chromium is installed")
def test_a_browser_shows_it(fallen, tmp_path):
    """Bodies in their colours, moved by the slider, without an error or a request."""
    _, result = fallen
    page = result.page(trace=["two.end"], title="Two bars that fall")
    file = tmp_path / "page.html"
    file.write_text(page.text.replace("</body>", LOOK + "</body>"), encoding="utf-8")
    seen = browse(file)
    blue, orange = seen["colours"]
    assert blue > 500 and orange > 500
    assert seen["moved"] and seen["back"]
    assert seen["state"] == "time 0 s"
    assert seen["diagrams"] == 2
    assert seen["requests"] == [] and seen["errors"] == []


def browse(file):
    """What the page at the end of :data:`LOOK` says of itself."""
    done = subprocess.run(
        [
            BROWSER,
            "--headless=new",
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            f"--user-data-dir={file.parent / 'profile'}",
            "--virtual-time-budget=2000",
            "--dump-dom",
            file.as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    found = re.search(r'<pre id="report">(.*?)</pre>', done.stdout, re.S)
    assert found, done.stderr
    return json.loads(found.group(1).replace("&lt;", "<").replace("&gt;", ">"))


@pytest.mark.parametrize(("count", "most"), [(1, 3), (5, 1), (5, 9), (7, 2), (39, 7), (40, 39)])
def test_states_of_statics_are_chosen_evenly(count, most):
    """At most so many, and each once; of several the first and the last."""
    found = content(fl.statics(pulled(), levels=np.linspace(1 / count, 1, count)).page(states=most))
    rows = np.round(np.array(found["states"]) * count).astype(int) - 1
    assert len(rows) == min(count, most)
    assert rows[0] == 0 and (rows[-1] == count - 1 or most == 1)
    assert np.diff(rows).max(initial=0) <= np.ceil((count - 1) / max(most - 1, 1))
    assert np.diff(rows).min(initial=1) >= 1


def pulled():
    """A short bar, pulled a little."""
    section = fl.Section.rectangle(0.02, 0.02, fl.Material(2e11, 0.3, 7800.0))
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=1, name="beam"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(1.0, 0, 0)))
    return scene
