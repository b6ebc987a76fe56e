"""A page for each demo and study: its docstring, pictures, last run and code.

No demo is run: pictures, output and records are those of ``docs/gallery``, which
``tools/run python3 -m tools.site.gallery [NAME…]`` makes again with the options of
``tools/records.py``.
"""

from __future__ import annotations

import ast
import json
import subprocess
import sys
import time
from pathlib import Path

from PIL import Image

from tools.records import HELPERS, SHORT

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "docs" / "gallery"
WIDTH = 900
"""Largest width of a picture on a page, pixels."""

GROUPS = {
    "Beams and rods at rest": (
        "rollup bend45 elastica twisted_beam branching_frame own_energy section_properties "
        "stiff_energy rings catenary hanging_cable"
    ),
    "Shells": (
        "hemisphere semi_cylinder pulled_cylinder pinched_cylinder slit_annulus "
        "cantilever_shear cantilever_moment laminate i_beam_shell adaptive_shell adaptive_goals "
        "adaptive_splines"
    ),
    "Solids": "cooks_membrane solid_hub bracket",
    "Buckling and snapping": (
        "euler_column deep_arch hinged_roof lateral_torsional spherical_cap bistable_strip "
        "thin_cylinder compressed_cylinder folding_sheet flutter"
    ),
    "Mechanisms": (
        "four_bar double_four_bar bricard governor slider_crank truss_deployment "
        "hoop_antenna rolling_disc rod_in_box deployed_panels inverted_pendulum crane "
        "slider_crank_friction stick_slip woodpecker squeezer bicycle"
    ),
    "Motion": (
        "double_pendulum heavy_top free_rigid_body tumbling_body rotating_beam spin_up "
        "frequency_response whirl turbine_blade "
        "flapping_plate tumbling_plate wave_in_a_net space_net net_capture "
        "variational_pendulum order_four adaptive_wave reduced_pendulum"
    ),
    "Studies": (
        "local_frame_claims speed_against_error speed_against_error_shells time_error "
        "variable_step conservation_against_time cylinder_knock_down "
        "pendulum_conservation linear_shells elements_on_a_bend heavy_top_groups truss_policies "
        "stiffly_accurate penalty_beside_cones"
    ),
}


def demos() -> list[str]:
    """Names of all demos and studies."""
    files = (*(ROOT / "demos").glob("*.py"), *(ROOT / "studies").glob("*.py"))
    return sorted(file.stem for file in files if file.stem not in HELPERS)


def script(name: str) -> Path:
    """Path of a demo or study, relative to the root."""
    demo = Path("demos") / f"{name}.py"
    return demo if (ROOT / demo).exists() else Path("studies") / f"{name}.py"


def command(name: str) -> list[str]:
    """Arguments of Python that run a demo."""
    file = script(name)
    return [str(file)] if file.parent.name == "demos" else ["-m", f"studies.{name}"]


def grouped() -> dict[str, list[str]]:
    """Names of all demos by heading; those without one come last."""
    left = set(demos())
    groups = {}
    for heading, names in GROUPS.items():
        groups[heading] = [name for name in names.split() if name in left]
        left -= set(groups[heading])
    return {**groups, "More": sorted(left)} if left else groups


def said(name: str) -> tuple[str, str]:
    """First line and rest of the docstring of a demo."""
    source = (ROOT / script(name)).read_text(encoding="utf-8")
    text = ast.get_docstring(ast.parse(source)) or ""
    first, _, rest = text.partition("\n")
    return first, rest.strip()


def title(name: str) -> str:
    """Title of the page of a demo."""
    words = name.replace("_", " ")
    return words[0].upper() + words[1:]


def page(name: str) -> str:
    """Page of a demo, in Markdown."""
    first, rest = said(name)
    given = " ".join([*command(name), *SHORT.get(name, "").split()])
    parts = [f"# {title(name)}", first, *_escaped(rest)]
    parts += [f"![{first.rstrip('.')}]({file.name})" for file in pictures(name)]
    output, record = KEPT / f"{name}.txt", KEPT / f"{name}.json"
    printed = output.read_text(encoding="utf-8").rstrip() if output.exists() else ""
    if printed:
        parts += ["## Last run", f"`tools/run python3 {given}`", f"```text\n{printed}\n```"]
    if record.exists() and (rows := table(record, named(printed))):
        parts += [f":::{{dropdown}} More numbers of its record (`--json`)\n{rows}\n:::"]
    parts += ["## Code", f"```{{literalinclude}} ../../{script(name)}\n:language: python\n```"]
    return "\n\n".join(parts) + "\n"


def _escaped(text: str) -> list[str]:
    """Paragraphs of a docstring, with Markdown's brackets escaped."""
    return [part.replace("<", "\\<").replace("[", "\\[") for part in text.split("\n\n") if part]


def table(record: Path, printed: set[str]) -> str:
    """Table of the single numbers of a record whose names are not printed; empty without any."""
    found = json.loads(record.read_text(encoding="utf-8"))
    more = {
        key: value
        for key, value in found.items()
        if isinstance(value, int | float | str) and not {key, key.replace("_", " ")} & printed
    }
    rows = [f"| `{key}` | {_shown(value)} |" for key, value in more.items()]
    return "\n".join(["| | |", "|---|---|", *rows]) if rows else ""


def named(printed: str) -> set[str]:
    """Names in front of the values of an output: the text of each line up to two spaces."""
    return {line.partition("  ")[0].strip() for line in printed.splitlines()}


def _shown(value: float | str) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return "`" + text.replace("|", "\\|").replace("\n", " ")[:200] + "`"


def pictures(name: str) -> list[Path]:
    """Pictures of a demo; the first one is that of its card."""
    others = set(demos()) - {name}
    found = [KEPT / f"{name}.png", *sorted(KEPT.glob(f"{name}_*.png"))]
    return [
        file
        for file in found
        if file.exists()
        and not any(file.stem.startswith(o) for o in others if o.startswith(f"{name}_"))
    ]


def write(docs: Path) -> None:
    """Write the pages of all demos, and the gallery that links to them."""
    parts = ["# Gallery", "Every demo: its code, its picture, and its last run."]
    for heading, names in grouped().items():
        cards = []
        for name in names:
            (docs / "gallery" / f"{name}.md").write_text(page(name), encoding="utf-8")
            image = [
                f":img-top: {file.name}\n:img-alt: {said(name)[0]}" for file in pictures(name)[:1]
            ]
            lines = [f":::{{grid-item-card}} {title(name)}", f":link: {name}", ":link-type: doc"]
            cards.append("\n".join([*lines, *image, said(name)[0], ":::"]))
        parts += [f"## {heading}", "\n".join(["::::{grid} 2 3 3 3", ":gutter: 2", *cards, "::::"])]
        listed = "\n".join(names)
        parts += [f"```{{toctree}}\n:hidden:\n\n{listed}\n```"]
    (docs / "gallery" / "index.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def make(name: str) -> None:
    """Run a demo and store its record, output and pictures."""
    start, results = time.time(), ROOT / "results"
    words = [sys.executable, *command(name), "--json", str(KEPT / f"{name}.json")]
    words += SHORT.get(name, "").split()
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    output = done.stdout.replace(f"{ROOT}/", "")
    (KEPT / f"{name}.txt").write_text(output, encoding="utf-8")
    for file in sorted(results.glob("*.png")):
        if file.stat().st_mtime >= start:
            keep(file)


def keep(file: Path) -> None:
    """Store a picture at most :data:`WIDTH` wide, in 128 colours."""
    picture = Image.open(file).convert("RGB")
    if picture.width > WIDTH:
        picture = picture.resize((WIDTH, round(picture.height * WIDTH / picture.width)))
    picture.quantize(128).save(KEPT / file.name, optimize=True)


if __name__ == "__main__":
    for demo in sys.argv[1:] or demos():
        print(demo, flush=True)
        make(demo)
