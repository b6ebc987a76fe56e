"""Demos, as a package for tests and studies.

What demos share lies beside them, and is found there when they run as scripts. Here, too.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parent))
