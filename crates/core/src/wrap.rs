//! Wrapping (paper, 4.2 steps 2 and 4): points of the planar domain mapped back to the surface.
