//! Black-box tests of the program: what a person types, sees and gets.

mod bad_input;
mod common;
mod outputs;
mod repairs;
mod wrap;
mod wrong_use;
