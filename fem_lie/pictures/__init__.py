"""Pictures, pages and files of bodies, frames and arrays; independent of the classes of results."""
