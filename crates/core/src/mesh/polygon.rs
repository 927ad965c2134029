//! Triangulates polygons with more than three corners.
