"""The compiler: decorators of compiled code, and a disk cache of it that can be trusted.

Parts of numba that it does not document are used where the documented ones cost more than they
save. Each release may change them, so that the project's metadata admit only releases with which
the tests have passed. ``docs/measured/decisions.md`` has what was measured.

- Functions that compiled functions call get no machine code of their own (:mod:`.libraries`
  exchanges the class of numba's libraries and ``set_env`` of its code generator for the time of a
  compilation). ``numba.njit`` makes it of every function: 15.7 of 59 s of a first run.
- A call with a constant counts as one with its type (``get_call_template`` of :mod:`.decorators`).
  ``numba.njit`` compiles a function for each value: a fifth of all sets of types.
- A function becomes a dispatcher at its first call from Python, by a change of its own class. Made
  at once, each of the thousand takes half a millisecond at each import; a second object in front
  would lengthen each call.
- Loops over records of arrays count no references (option ``_nrt``). No documented option switches
  that off: it takes up to seven tenths of the time of contacts.
- The level of optimisation is set for each function (``numba.config.OPT``). numba documents it for
  a whole process alone, and would optimise loops over steps anew at each level of calls.
- Caches of functions are subclasses of those of numba. With ``cache=True`` a function would survive
  a change of what it has inlined from another file, and damaged files would be executed.

``exec`` makes the function that Python calls, with the names of the parameters of the one that it
calls: numba resolves calls by keyword from them, and takes none with ``*arguments``.
"""

from fem_lie._jit.decorators import (
    callback,
    compiled,
    inlined,
    inlined_series,
    inlined_uncounted,
    linked,
    uncounted,
)
from fem_lie._jit.progress import compiling

__all__ = [
    "callback",
    "compiled",
    "compiling",
    "inlined",
    "inlined_series",
    "inlined_uncounted",
    "linked",
    "uncounted",
]
