//! What figures are compared with: random, Hilbert order, Poisson disk, lattices on the sphere.
