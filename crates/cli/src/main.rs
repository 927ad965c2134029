//! The program `ldwrap-cli`.

mod picture;

fn main() {}
