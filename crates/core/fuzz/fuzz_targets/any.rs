//! Any bytes as a mesh that its content tells, compressed or not.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| ldwrap_fuzz::readers::any(bytes));
