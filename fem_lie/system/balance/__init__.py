"""What acts on a scene, and the books of what it has done."""
