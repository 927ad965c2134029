//! Shapes with known counts and areas, for tests, demos and the assets.
