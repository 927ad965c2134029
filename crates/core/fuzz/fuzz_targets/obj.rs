//! Any bytes as Obj.
#![no_main]

use ldwrap::io::MeshFormat;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| ldwrap_fuzz::readers::mesh(MeshFormat::Obj, bytes));
