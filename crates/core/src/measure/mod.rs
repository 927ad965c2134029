//! Measures of any point set on a surface; they import no stage.
