//! Joint impedance gives the paper's torque within its limits, or an error.

use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use whole_body::Error;
use whole_body::robot::JointLimits;
use whole_body::torque::{ImpedanceSettings, JointImpedance, JointState, RateLimit};

const EFFORT: [f64; 7] = [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0];
const DT: f64 = 0.001;

fn panda(settings: ImpedanceSettings) -> Result<JointImpedance, Error> {
    JointImpedance::new(
        settings,
        &EFFORT.map(|effort| JointLimits { effort, ..JointLimits::UNLIMITED }),
    )
}

fn unlimited() -> JointImpedance {
    let settings = ImpedanceSettings { torque_rate: f64::INFINITY, ..ImpedanceSettings::default() };
    JointImpedance::new(settings, &[JointLimits::UNLIMITED; 7]).unwrap()
}

fn seven(size: f64) -> impl Strategy<Value = [f64; 7]> {
    prop::array::uniform7(-size..size)
}

proptest! {
    #[test]
    fn without_limits_the_torque_is_the_papers(
        q_desired in seven(3.0), v_desired in seven(2.0), q in seven(3.0), v in seven(2.0), g in seven(50.0),
    ) {
        let stiffness = [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0];
        let damping = [50.0, 50.0, 50.0, 20.0, 20.0, 20.0, 10.0];
        let mut impedance = unlimited();
        let desired = JointState { position: &q_desired, velocity: &v_desired };
        let measured = JointState { position: &q, velocity: &v };
        let torque = impedance.torque(desired, measured, &g, DT).unwrap();
        for i in 0..7 {
            let expected = damping[i] * (v_desired[i] - v[i]) + stiffness[i] * (q_desired[i] - q[i]) + g[i];
            assert_abs_diff_eq!(torque[i], expected, epsilon = 1e-9);
        }
    }

    #[test]
    fn torque_and_its_rate_stay_within_limits(
        steps in prop::collection::vec((seven(1e3), seven(1e3), seven(200.0)), 1..50),
    ) {
        let mut impedance = panda(ImpedanceSettings::default()).unwrap();
        let mut last: Option<[f64; 7]> = None;
        for (q, v, g) in &steps {
            let desired = JointState { position: q, velocity: v };
            let measured = JointState { position: v, velocity: q };
            let torque: [f64; 7] =
                impedance.torque(desired, measured, g, DT).unwrap().try_into().unwrap();
            for i in 0..7 {
                prop_assert!(torque[i].abs() <= EFFORT[i]);
                let before = last.map_or(g[i].clamp(-EFFORT[i], EFFORT[i]), |last| last[i]);
                prop_assert!((torque[i] - before).abs() <= 1.0 + 1e-12);
            }
            last = Some(torque);
        }
    }

    #[test]
    fn torques_that_change_together_keep_their_balance(
        first in seven(10.0), last in seven(10.0), rate in prop_oneof![Just(1000.0), Just(f64::INFINITY)],
    ) {
        let settings = ImpedanceSettings { torque_rate: rate, ..ImpedanceSettings::default() };
        let mut impedance = panda(settings).unwrap();
        impedance.limit_rate(RateLimit::Together);
        let rest = JointState { position: &[0.0; 7], velocity: &[0.0; 7] };
        impedance.torque(rest, rest, &first, DT).unwrap();
        // Nothing is left after 20 ms, and until then each torque has the same share of its way.
        let mut share = 0.0;
        for _ in 0..20 {
            let torque = impedance.torque(rest, rest, &last, DT).unwrap();
            let ways = torque.iter().zip(first.iter().zip(&last));
            let shares: Vec<f64> = ways.map(|(now, (first, last))| (now - first) / (last - first)).collect();
            prop_assert!(shares[0] >= share - 1e-9);
            share = shares[0];
            for ((other, first), last) in shares.iter().zip(&first).zip(&last) {
                prop_assert!(((other - share) * (last - first)).abs() < 1e-9);
            }
        }
        prop_assert!((share - 1.0).abs() < 1e-9);
    }

    #[test]
    fn huge_numbers_give_limited_torque_or_error(
        q in prop::array::uniform7(prop::num::f64::ANY), v in prop::array::uniform7(prop::num::f64::ANY),
        g in prop::array::uniform7(prop::num::f64::ANY),
    ) {
        let mut impedance = panda(ImpedanceSettings::default()).unwrap();
        let desired = JointState { position: &q, velocity: &v };
        let measured = JointState { position: &v, velocity: &q };
        if let Ok(torque) = impedance.torque(desired, measured, &g, DT) {
            for (torque, effort) in torque.iter().zip(EFFORT) {
                prop_assert!(torque.abs() <= effort);
            }
        }
    }
}

#[test]
fn arm_at_its_target_only_supports_itself() {
    let mut impedance = panda(ImpedanceSettings::default()).unwrap();
    let state = JointState { position: &[0.4; 7], velocity: &[0.1; 7] };
    let gravity = [0.0, -38.0, -3.0, 18.0, 0.6, 1.5, 0.0];
    assert_eq!(impedance.torque(state, state, &gravity, DT).unwrap(), gravity);
}

#[test]
fn torque_rises_at_the_rate_limit() {
    let mut impedance = panda(ImpedanceSettings::default()).unwrap();
    let rest = JointState { position: &[0.0; 7], velocity: &[0.0; 7] };
    let desired = JointState { position: &[0.0175; 7], velocity: &[0.0; 7] }; // 10.5 Nm on joint 1
    let mut rise = |desired| impedance.torque(desired, rest, &[0.0; 7], DT).unwrap()[0];
    for tick in 1..=10 {
        assert_abs_diff_eq!(rise(desired), f64::from(tick), epsilon = 1e-12);
    }
    assert_abs_diff_eq!(rise(desired), 10.5, epsilon = 1e-12);
    assert_abs_diff_eq!(rise(rest), 9.5, epsilon = 1e-12);
    impedance.reset();
    assert_abs_diff_eq!(
        impedance.torque(rest, rest, &[2.0; 7], DT).unwrap()[0],
        2.0,
        epsilon = 1e-12
    );
}

#[test]
fn bad_input_gives_an_error_and_no_torque() {
    let mut impedance = panda(ImpedanceSettings::default()).unwrap();
    let rest = JointState { position: &[0.0; 7], velocity: &[0.0; 7] };
    let pulled = JointState { position: &[0.01; 7], velocity: &[0.0; 7] };
    impedance.torque(pulled, rest, &[0.0; 7], DT).unwrap();

    let mut nan = [0.0; 7];
    nan[3] = f64::NAN;
    let bad = JointState { position: &nan, velocity: &[0.0; 7] };
    let error = impedance.torque(rest, bad, &[0.0; 7], DT).unwrap_err();
    assert!(matches!(error, Error::Value { .. }));
    assert!(error.to_string().contains("measured position, joint 4"), "{error}");
    let error = impedance.torque(rest, rest, &[f64::INFINITY; 7], DT).unwrap_err();
    assert!(matches!(error, Error::Value { .. }));
    let error = impedance.torque(rest, rest, &[0.0; 6], DT).unwrap_err();
    assert!(matches!(error, Error::Size { got: 6, wanted: 7, .. }));
    for dt in [0.0, -0.001] {
        let error = impedance.torque(rest, rest, &[0.0; 7], dt).unwrap_err();
        assert!(matches!(error, Error::Value { .. }));
    }
    assert!(impedance.torque(rest, rest, &[0.0; 7], f64::NAN).is_err());

    // The rate limit continues from the last torque: 1 Nm, then at most 2 Nm.
    let torque = impedance.torque(pulled, rest, &[0.0; 7], DT).unwrap();
    assert_abs_diff_eq!(torque[0], 2.0, epsilon = 1e-12);
}

#[test]
fn settings_that_make_no_sense() {
    let default = ImpedanceSettings::default;
    let bad = |settings| panda(settings).unwrap_err();
    let error = bad(ImpedanceSettings { stiffness: vec![1.0; 6], ..default() });
    assert!(matches!(error, Error::Size { what: "stiffness", got: 6, wanted: 7 }));
    let error = bad(ImpedanceSettings { damping: vec![0.0; 7], ..default() });
    assert!(error.to_string().contains("damping of joint 1"), "{error}");
    let error = bad(ImpedanceSettings { stiffness: vec![f64::NAN; 7], ..default() });
    assert!(matches!(error, Error::Value { what, .. } if what == "the stiffness of joint 1"));
    let error = bad(ImpedanceSettings { torque_rate: -1.0, ..default() });
    assert!(matches!(error, Error::Value { .. }));
    let weak = [JointLimits { effort: 0.0, ..JointLimits::UNLIMITED }; 7];
    assert!(matches!(JointImpedance::new(default(), &weak), Err(Error::Value { .. })));
    assert!(panda(ImpedanceSettings::soft()).is_ok());
}
