//! Colours of strips and points.
