//! Any bytes as points; the first byte chooses the format.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| ldwrap_fuzz::readers::points(bytes));
