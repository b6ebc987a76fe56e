"""Chains of nodes eliminated onto what they hang on, in compiled code; the rest by a library.

Threads of a net and bars between joints are chains: a node has few neighbours, and when it is
eliminated the next one still has few. So all nodes that have at most :data:`~.elimination.MOST`
neighbours when their turn comes are eliminated one after the other, block by block, each onto its
neighbours::

    A_vv ← A_vv⁻¹      U = A_vv A_vn      A_nn ← A_nn − A_nv U

and what is left, knots and nodes at joints with their multipliers, is a small sparse matrix. Fill
stays within the blocks of pairs that were neighbours at some time, so that everything is in one
array; a general package would look for such pairs, and for dense parts that are not there.

There are no pivots but within a block. A block that is singular is an error, and the residual of
the solution is checked by :class:`~fem_lie.linear.direct.DirectSolver`: another method is next.
"""
