//! The program `ldwrap-cli`.
fn main() {}
