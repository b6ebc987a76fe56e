"""The compiler: decorators of compiled functions, and a disk cache that detects changes.

Parts of numba that it does not document are used where the documented ones are too slow. Each
release may change them, so the project's metadata admit only releases with which the tests have
passed. ``docs/measured/decisions.md`` has the measurements.

- Functions called by compiled functions get no machine code of their own (:mod:`.libraries`
exchanges the class of numba's libraries and ``set_env`` of its code generator during a
compilation). ``numba.njit`` makes machine code of every function: 15.7 of 59 s of a first run.
- A call with a constant counts as one with its type (``get_call_template`` of :mod:`.decorators`).
``numba.njit`` compiles a function for each value: a fifth of all sets of types.
- A function becomes a dispatcher at its first call from Python, by a change of its own class.
Creating the thousand dispatchers on import would take half a millisecond each; a second object in
front would lengthen each call.
- Loops over records of arrays count no references (option ``_nrt``). No documented option switches
that off: it takes up to seven tenths of the time of contacts.
- The optimisation level is set for each function (``numba.config.OPT``). numba documents it only
for a whole process, and would optimise loops over steps again at each level of calls.
- Caches of functions are subclasses of those of numba. With ``cache=True`` a function would survive
a change of what it has inlined from another file, and damaged files would be executed.

``exec`` makes the function that Python calls, with the parameter names of the compiled one: numba
resolves calls by keyword from them, and supports no ``*arguments``.
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
