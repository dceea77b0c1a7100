"""Rigid bodies: six unknowns each, in two rows after the nodes of the nodal arrays.

Row 0 of a body holds the displacement of its centre of mass (its X is the centre), row 1 the rotation. Nodes of its
parts and those attached to it have no unknowns of their own.
"""
