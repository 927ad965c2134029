//! Black-box tests of the program: what a person types, sees and gets.

mod attributes;
mod bad_input;
mod batch;
mod common;
mod compare;
mod measure;
mod outputs;
mod parts;
mod plane;
mod repairs;
mod shape;
mod stream;
mod view;
mod wrap;
mod wrong_use;
