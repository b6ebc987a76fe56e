"""The set-up asks before it uses sudo."""

import os
import pty
import shutil
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from select import select

import pytest

SETUP = Path(__file__).parents[1] / "tools" / "setup"
ASK = f'source {SETUP}; if may_be_root "apt-get install x"; then echo allowed; else echo no; fi'


ORDINARY = {"user": 65534, "group": 65534, "extra_groups": []} if os.geteuid() == 0 else {}
"""Who asks: an ordinary user."""


@pytest.fixture
def ask():
    """Call the set-up's question; its answer, whether sudo was called, what was said."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o777)
        fake = Path(folder, "sudo")
        fake.write_text(f'#!/bin/sh\necho "$@" >>{folder}/calls\n')
        fake.chmod(0o755)
        for needed in (SETUP, fake):
            if subprocess.run(["cat", needed], stdout=subprocess.DEVNULL, **ORDINARY).returncode:
                pytest.skip(f"an ordinary user cannot read {needed}")
        yield partial(_answer, Path(folder))


def _answer(folder, answer=None, **given):
    environment = {k: v for k, v in os.environ.items() if k != "FEM_LIE_SUDO"} | given
    environment["PATH"] = f"{folder}:{environment['PATH']}"
    primary, terminal = pty.openpty()
    try:
        ends = {"stdin": terminal, "stderr": terminal}
        if answer is None:
            ends = {"stdin": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        else:
            os.write(primary, f"{answer}\n".encode())
        done = subprocess.run(
            ["bash", "-c", ASK],
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
            timeout=60,
            **ends,
            **ORDINARY,
        )
        said = done.stderr if answer is None else _all_of(primary)
    finally:
        os.close(primary)
        os.close(terminal)
    return done.stdout.strip(), (folder / "calls").exists(), said


def _all_of(terminal):
    """What was written to a terminal: one read may return a part of it, such as the echo alone."""
    said = b""
    while select([terminal], [], [], 0.2)[0]:
        said += os.read(terminal, 4096)
    return said.decode()


def test_without_a_terminal_sudo_is_not_used(ask):
    assert ask() == ("no", False, "")


@pytest.mark.parametrize(
    ("answer", "result"), [("y", "allowed"), ("yes", "allowed"), ("", "no"), ("n", "no")]
)
def test_on_a_terminal_it_says_what_and_asks(ask, answer, result):
    found, _, said = ask(answer)
    assert found == result
    assert "with sudo: apt-get install x" in said and "go on? [y/N]" in said


@pytest.mark.parametrize("answer", [None, "n"])
def test_a_variable_allows_it_without_a_question(ask, answer):
    found, used, said = ask(answer, FEM_LIE_SUDO="yes")
    assert (found, used) == ("allowed", True)
    assert "with sudo: apt-get install x" in said and "go on?" not in said


def test_a_variable_forbids_it(ask):
    assert ask("y", FEM_LIE_SUDO="no")[:2] == ("no", False)


@pytest.mark.skipif(os.geteuid() != 0, reason="for root")
def test_setup_continues_as_root(tmp_path):
    done = subprocess.run(["bash", "-c", ASK], stdin=subprocess.DEVNULL, capture_output=True)
    assert done.stdout == b"allowed\n"


def test_another_value_of_the_variable_is_named():
    environment = os.environ | {"FEM_LIE_SUDO": "maybe"}
    command = [shutil.which("bash"), str(SETUP), "--status"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "FEM_LIE_SUDO is 'maybe', wanted is yes, no or nothing" in done.stderr


INSTALLS_PYTHON = """
source {setup}
cache={folder}/cache key=key HOSTNAME=host
try_python() {{ return 1; }}
try_distribution() {{
  ln --symbolic "$(readlink --canonicalize {python})" {folder}/python3
  found=it
}}
mention_blas() {{
  "$BASH" -c 'source {common}; cache={folder}/cache key=key HOSTNAME=host; read_choice && echo $way'
}}
choose
"""


def test_the_choice_is_found_where_the_distribution_brings_the_first_python(tmp_path):
    """Else the set-up would wait for itself, as on a bare Debian."""
    tools = tmp_path / "bin"
    tools.mkdir()
    for name in ("awk", "bash", "cat", "cut", "dirname", "ln", "mkdir", "mv", "readlink", "sed"):
        (tools / name).symlink_to(shutil.which(name))
    (tools / "sha256sum").symlink_to(shutil.which("sha256sum"))
    common = SETUP.with_name("common.bash")
    code = INSTALLS_PYTHON.format(setup=SETUP, folder=tools, common=common, python=sys.executable)
    environment = {"PATH": str(tools), "HOME": str(tmp_path)}
    done = subprocess.run(
        [shutil.which("bash"), "-c", code], env=environment, capture_output=True, text=True
    )
    assert done.stdout.strip() == "distribution", done.stderr


@pytest.mark.parametrize(
    ("log", "verdict"),
    [
        ("I: resolving what to install\nE: no such thing\n", "mmdebstrap failed, E: no such thing"),
        ("Unpacking libconnect ...\ndpkg: error: it broke\n", "mmdebstrap failed, dpkg: error: it"),
        ("E: Failed to fetch http://x/y.deb\n", "do not answer or do not have unstable"),
        ("Err:4 http://x unstable\n  404  Not Found\n", "do not answer or do not have unstable"),
        ("E: The repository 'x' does not have a Release file.\n", "do not have unstable"),
        ("cannot write: No space left on device\n", "is full"),
    ],
)
def test_a_failure_of_the_private_root_says_what_apt_says(tmp_path, log, verdict):
    (tmp_path / "setup.log").write_text(log)
    (tmp_path / "debian.sources").write_text("URIs: http://x\n")
    code = f"source {SETUP}; work={tmp_path}; explain_failure $work/setup.log; echo $verdict"
    environment = os.environ | {"FEM_LIE_SUITE": "unstable"}
    done = subprocess.run(["bash", "-c", code], env=environment, capture_output=True, text=True)
    assert verdict in done.stdout


def test_the_root_of_another_suite_is_another_one():
    code = f"source {SETUP}; echo $SUITE $root ${{FEM_LIE_WAY:-any}}"
    environment = {k: v for k, v in os.environ.items() if not k.startswith("FEM_LIE")}
    found = [
        subprocess.check_output(["bash", "-c", code], env=environment | suite, text=True).split()
        for suite in ({}, {"FEM_LIE_SUITE": "unstable"})
    ]
    assert [each[0] for each in found] == ["trixie", "unstable"]
    assert [each[2] for each in found] == ["any", "root"]
    assert found[0][1] != found[1][1]


@pytest.mark.parametrize("name", ["", "../trixie"])
def test_a_suite_that_is_none_is_refused(name):
    done = subprocess.run(["bash", SETUP, "--suite", name], capture_output=True, text=True)
    assert done.returncode == 1 and f"--suite is '{name}'" in done.stderr
