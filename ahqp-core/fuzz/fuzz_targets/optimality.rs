//! Compares three ticks of one shape, cold and warm, with exact arithmetic.
#![no_main]

use ahqp_core::{Settings, Solver, WarmStart};
use ahqp_core_fuzz::{Bytes, expect_right};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let shape = bytes.shape();
    let ticks: Vec<_> = (0..3).map(|_| bytes.tick(&shape)).collect();
    let mut solvers = [WarmStart::Cold, WarmStart::PreviousActiveSet].map(|warm_start| {
        let settings = Settings { warm_start, ..Settings::default() };
        Solver::new(&ticks[0], settings).expect("settings in range")
    });
    for hierarchy in &ticks {
        expect_right(&mut solvers, hierarchy);
    }
});
