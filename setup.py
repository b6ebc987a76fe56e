"""Puts machine code for a generic processor into wheels that are built where DOLFINx is."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

WITH_MACHINE_CODE = importlib.util.find_spec("dolfinx") is not None


class Build(build_py):
    """Copies the sources, and compiles what most runs need of them."""

    def run(self) -> None:
        """Build."""
        super().run()
        if not WITH_MACHINE_CODE or self.editable_mode:
            return
        built = Path(self.build_lib).resolve()
        script = (
            "from pathlib import Path; from fem_lie import _precompile; "
            f"_precompile.write_generic(Path({str(built / 'fem_lie' / '_machine_code')!r}))"
        )
        path = os.pathsep.join([str(built), *filter(None, [os.environ.get("PYTHONPATH")])])
        environment = os.environ | {"PYTHONPATH": path}
        subprocess.run([sys.executable, "-c", script], cwd=built, env=environment, check=True)


class Binary(Distribution):
    """A distribution whose wheels are for one Python and one platform."""

    def has_ext_modules(self) -> bool:
        """Whether they have machine code."""
        return WITH_MACHINE_CODE


setup(cmdclass={"build_py": Build}, distclass=Binary)
