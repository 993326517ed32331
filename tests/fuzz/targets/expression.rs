#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fetifeti_cli::fuzz::expression(bytes));
