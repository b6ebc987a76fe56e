"""Beams with sections that distort and warp in few modes."""
