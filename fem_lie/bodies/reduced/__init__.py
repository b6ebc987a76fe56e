"""Bodies that move with one frame and deform in few shapes: what scenes know of reduction."""
