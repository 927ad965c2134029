//! Pure mathematics in double precision: knows no mesh and no ids.

pub mod plane;
pub mod triangle;
