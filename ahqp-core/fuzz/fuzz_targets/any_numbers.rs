//! Arbitrary numbers lead to an error, or to a point that satisfies the hard constraints.
#![no_main]

use ahqp_core::{Settings, Solver};
use ahqp_core_fuzz::Bytes;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let hierarchy = bytes.wild();
    let mut solver = Solver::new(&hierarchy, Settings::default()).expect("settings in range");
    // First a cold start, then a warm one.
    for _ in 0..2 {
        let Ok(solution) = solver.solve(&hierarchy) else { continue };
        let x = solution.best().to_vec();
        let bounds = hierarchy.lower().iter().zip(hierarchy.upper());
        assert!(
            x.iter().zip(bounds).all(|(x, (lower, upper))| (lower..=upper).contains(&x)),
            "{x:?}: {hierarchy:?}"
        );
        if let Ok(certificate) = solver.certificate(&hierarchy) {
            let residuals = certificate.residuals(&hierarchy, &x).expect("the same hierarchy");
            assert!(residuals.feasibility < 1e-8, "{residuals:?} at {x:?}: {hierarchy:?}");
        }
    }
});
