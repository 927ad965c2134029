//! The pipeline on any soup.
#![no_main]

use ldwrap_fuzz::soups::{Case, pipeline};

libfuzzer_sys::fuzz_target!(|case: Case| pipeline(&case));
