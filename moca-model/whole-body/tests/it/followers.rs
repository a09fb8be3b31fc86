//! Limits of mimic joints.

use proptest::prelude::*;
use whole_body::limits::LimitKind;
use whole_body::robot::{LimitOverride, Warning};
use whole_body::tasks::PostureTask;
use whole_body::{Description, Ik, Model};

use crate::support::stacks::PERIOD;

/// A model with j1 and j2 = multiplier j1 + offset.
fn model(multiplier: f64, offset: f64, limits: [&str; 2], description: &Description) -> Model {
    let urdf = format!(
        r#"<robot name="m"><link name="a"/><link name="b"/><link name="c"/>
           <joint name="j1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>{}
           </joint><joint name="j2" type="revolute"><parent link="b"/><child link="c"/>
           <axis xyz="0 0 1"/><mimic joint="j1" multiplier="{multiplier}" offset="{offset}"/>{}
           </joint></robot>"#,
        limits[0], limits[1]
    );
    Model::from_urdf(&urdf, description).unwrap()
}

const ONE: &str = r#"<limit lower="-1" upper="1" velocity="2" effort="5"/>"#;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// The posture has any target and speed.
    #[test]
    fn are_kept(
        multiplier in prop_oneof![-4.0..-0.3_f64, 0.3..4.0_f64], offset in -0.5..0.5_f64,
        target in prop_oneof![Just(5.0), Just(-5.0)],
    ) {
        let model = model(multiplier, offset, [ONE, ONE], &Description::default());
        let mut q = vec![(-offset / multiplier).clamp(-0.9, 0.9)];
        prop_assume!((multiplier * q[0] + offset).abs() < 0.9);
        let mut builder = Ik::builder(&model);
        let posture = builder.push("posture", PostureTask::new().with_gain(20.0));
        let mut ik = builder.build_at(&q).unwrap();
        ik.task_mut(posture).unwrap().set_target(&[target]).unwrap();
        for _ in 0..3000 {
            let step = ik.step(&q, PERIOD).unwrap();
            let speed = step.velocity()[0].abs();
            prop_assert!(speed.max(speed * multiplier.abs()) <= 2.0 * (1.0 + 1e-9));
            step.integrate(&mut q).unwrap();
            let follower = multiplier * q[0] + offset;
            prop_assert!(q[0].abs() <= 1.0 + 1e-9 && follower.abs() <= 1.0 + 1e-9);
        }
        // One of the two joints is at its limit.
        prop_assert!((1.0 - q[0].abs()).min(1.0 - (multiplier * q[0] + offset).abs()) < 1e-6);
    }
}

#[test]
fn are_named_where_they_are_in_force() {
    let model = model(2.0, 0.0, [ONE, ONE], &Description::default());
    let limits = model.limits()[0];
    assert_eq!((limits.lower, limits.upper, limits.velocity), (-0.5, 0.5, 1.0));
    assert_eq!(limits.acceleration, 1.0 / 0.25);
    let follower = |which: &str| Warning::FollowerLimit {
        joint: "j2".to_owned(),
        follows: "j1".to_owned(),
        limit: if which == "velocity" { "velocity" } else { "range of positions" },
    };
    assert!(model.warnings().contains(&follower("position")));
    assert!(model.warnings().contains(&follower("velocity")));
    let mut q = vec![0.0];
    let mut builder = Ik::builder(&model);
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&q).unwrap();
    ik.task_mut(posture).unwrap().set_target(&[0.95]).unwrap();
    for _ in 0..3000 {
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
    }
    let step = ik.step(&q, PERIOD).unwrap();
    let active: Vec<_> = step.active_limits().collect();
    assert_eq!((active[0].entry, active[0].name, active[0].kind), (0, "j2", LimitKind::Position));
}

#[test]
fn looser_or_missing_limits_change_nothing() {
    let unwarned = |model: &Model| {
        let ours = |warning: &&Warning| {
            matches!(warning, Warning::FollowerLimit { .. } | Warning::FollowerRange { .. })
        };
        model.warnings().iter().filter(ours).count() == 0
    };
    for follower in [ONE, "", r#"<limit lower="0" upper="0" velocity="0" effort="0"/>"#] {
        let model = model(0.9, 0.0, [ONE, follower], &Description::default());
        let limits = model.limits()[0];
        assert_eq!((limits.lower, limits.upper, limits.velocity), (-1.0, 1.0, 2.0));
        assert!(unwarned(&model), "{:?}", model.warnings());
    }
}

#[test]
fn described_limits_count_and_empty_ranges_warn() {
    let own = LimitOverride { position: Some((-0.3, 0.6)), ..LimitOverride::default() };
    let limits = vec![("j2".to_owned(), own)];
    let description = Description { limits, ..Description::default() };
    let narrowed = model(-1.0, 0.0, [ONE, ""], &description).limits()[0];
    assert_eq!((narrowed.lower, narrowed.upper), (-0.6, 0.3));
    let beyond = r#"<limit lower="2" upper="3" velocity="2" effort="5"/>"#;
    let apart = model(1.0, 0.0, [ONE, beyond], &Description::default());
    assert_eq!((apart.limits()[0].lower, apart.limits()[0].upper), (-1.0, 1.0));
    let text = apart.warnings().iter().map(ToString::to_string).collect::<String>();
    assert!(text.contains("j2") && text.contains("is not kept"), "{text}");
}
