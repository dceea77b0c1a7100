"""Change Young's modulus of a .feb file: one line of it changes."""

import febkit

m = febkit.read("plug.feb")
m.materials["cartilage"].solid.E = 0.8
m.write("stiffer.feb")
