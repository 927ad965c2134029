//! Any bytes as Stl.
#![no_main]

use ldwrap::io::MeshFormat;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| ldwrap_fuzz::readers::mesh(MeshFormat::Stl, bytes));
