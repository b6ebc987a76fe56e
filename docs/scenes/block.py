"""A soft block is bent: bricks of a hyperelastic material."""

import fem_lie as fl

soft = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1000.0)
block = fl.Solid.brick((4, 1, 1), soft, cells=(8, 2, 2), degree=2)
block.clamp("a=0")
scene = fl.Scene()
scene.add(block)
scene.add(fl.loads.FaceLoad(block, "a=1", force=(0, 0, -1e4)))
result = fl.follow_loads(scene)
result.picture("block.png")
result.page("block.html")
