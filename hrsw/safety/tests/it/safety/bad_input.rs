//! Settings and inputs that are out of range are named.

use super::*;

#[test]
fn bad_safety_input_is_named() {
    let bad = [
        SeparationSettings { deceleration: 0.0, ..SeparationSettings::default() },
        SeparationSettings { human_speed: f64::NAN, ..SeparationSettings::default() },
        SeparationSettings { intrusion: -0.1, ..SeparationSettings::default() },
    ];
    for settings in bad {
        assert!(matches!(ApproachRows::new(state(), settings, 3), Err(Error::Value { .. })));
    }
    let settings = SeparationSettings::default();
    let mut separation = ApproachRows::new(state(), settings, 3).unwrap();
    let mut rows = separation.rows();
    let before = rows.clone();
    let (jacobian, rest) = (Matrix6xX::zeros(JOINTS), [0.0; JOINTS]);
    let origin = Vector3::zeros();
    let motion = motion(&jacobian, origin, &rest, &rest);
    let short = JointMotion { braking: Some(&rest[1..]), ..motion };
    assert!(matches!(separation.write(&short, &[], &[], &mut rows), Err(Error::Size { .. })));
    let nan = JointMotion { velocity: &[f64::NAN; JOINTS], ..motion };
    assert!(matches!(separation.write(&nan, &[], &[], &mut rows), Err(Error::Value { .. })));
    let wrong = separation.write(&motion, &[], &[], &mut Rows::zeros(2, state().len()));
    assert!(matches!(wrong, Err(Error::Size { .. })));
    assert!(separation.measure_own(&motion, &[], &[(0, 1)]).is_err());
    let body = Capsule::sphere(origin, 0.1).unwrap();
    let person = PersonBody {
        assumed_speed: 1.6,
        capsule: body,
        velocity: None,
        age: 0.0,
        uncertainty: 0.0,
        contact: None,
    };
    let adrift = |mean: f64, uncertainty: f64| PersonBody {
        velocity: Some(MeasuredVelocity { mean: Vector3::repeat(mean), uncertainty }),
        ..person
    };
    let touched = |force: f64, mass: f64, fastest: f64| PersonBody {
        contact: Some(Contact {
            limit: ContactLimit { force, stiffness: 1e4, mass },
            fastest,
            velocity: None,
        }),
        ..person
    };
    for part in [
        adrift(f64::NAN, 0.0),
        adrift(0.0, f64::NAN),
        adrift(0.0, -1.0),
        PersonBody { age: -0.1, ..person },
        PersonBody { age: f64::NAN, ..person },
        PersonBody { uncertainty: -0.1, ..person },
        PersonBody { uncertainty: f64::NAN, ..person },
        touched(0.0, 1.0, 0.2),
        touched(1.0, -1.0, 0.2),
        touched(1.0, 1.0, f64::INFINITY),
    ] {
        assert!(separation.write(&motion, &[], &[part], &mut rows).is_err());
    }
    for inverse in
        [DMatrix::zeros(JOINTS, JOINTS - 1), DMatrix::from_element(JOINTS, JOINTS, f64::NAN)]
    {
        let motion = JointMotion { inverse_inertia: Some(&inverse), ..motion };
        assert!(separation.write(&motion, &[], &[], &mut rows).is_err());
    }
    assert_eq!(rows, before);
    assert_eq!(separation.write(&motion, &[], &[], &mut rows), Ok(None));

    let mut cap = SpeedCap::rows(state());
    assert!(SpeedCap::write(&motion, &Vector3::zeros(), -1.0, &mut cap).is_err());
    assert!(SpeedCap::write(&motion, &Vector3::zeros(), f64::NAN, &mut cap).is_err());
    let bad = [
        SupervisorSettings { reduced_age: -1.0, ..SupervisorSettings::default() },
        SupervisorSettings { stop_age: 0.0, ..SupervisorSettings::default() },
        SupervisorSettings { contact_force: 0.0, ..SupervisorSettings::default() },
    ];
    for settings in bad {
        let error = Supervisor::new(settings).unwrap_err();
        assert!(error.to_string().contains("supervisor."), "{error}");
    }
}
