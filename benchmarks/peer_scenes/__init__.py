"""The pieces of ``benchmarks/peers.py``: the same scenes in this library and in others.

``descriptions`` says in numbers alone what is in a scene. ``ours``, ``exudyn_peer`` and
``kratos_peer`` are programs, each in a process of its own, that answer requests, lines of JSON,
with lines of JSON; the peers' run in a virtual environment (``environment``) and import nothing
from here. ``comparisons`` has what is run, and against what; ``report`` writes tables and plots.
"""
