"""Static condensation of chains of nodes in compiled code; a package factorises the rest.

Cables of a net and bars between joints are chains: a node has few neighbours, and when it is
eliminated the next one still has few. All nodes with at most :data:`~.elimination.MOST` neighbours
are therefore eliminated one after the other, block by block, onto their neighbours::

    A_vv ← A_vv⁻¹      U = A_vv A_vn      A_nn ← A_nn − A_nv U

The remaining nodes, at junctions and joints, with their multipliers make a small sparse matrix.
Fill stays within the blocks of pairs that were neighbours at some time, so that one array contains
everything; a general package would search for such pairs, and for dense parts that do not exist.

Pivoting is restricted to the blocks. A singular block is an error, and
:class:`~fem_lie.linear.direct.DirectSolver` checks the residual of the solution: another method is
tried next.
"""
