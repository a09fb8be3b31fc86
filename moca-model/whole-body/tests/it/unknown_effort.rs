//! Files as ROS-Industrial and others write them, with efforts of zero and other encodings.

use whole_body::robot::{JointLimits, LimitOverride, UrdfError};
use whole_body::simulation::{JointDrive, RigidBodySimulation};
use whole_body::torque::{Compensation, ImpedanceSettings, TorqueControl, TorqueSettings};
use whole_body::{Data, Description, Error, Model};

fn urdf(limit: &str) -> String {
    format!(
        r#"<robot name="one"><link name="base"/><link name="tip"><inertial><mass value="2"/>
           <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
           <joint name="hinge" type="revolute"><parent link="base"/><child link="tip"/>
           <axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" {limit}/></joint></robot>"#
    )
}

fn torque_control(model: &Model) -> Result<TorqueControl, Error> {
    let impedance =
        ImpedanceSettings { stiffness: vec![400.0], damping: vec![20.0], torque_rate: 1000.0 };
    let settings = TorqueSettings { impedance, ..TorqueSettings::new(Compensation::BARE) };
    TorqueControl::new(model, settings, &[0.1])
}

#[test]
fn zero_effort_counts_as_unknown() {
    for limit in [r#"effort="0""#, ""] {
        let model = Model::from_urdf(&urdf(limit), &Description::default()).unwrap();
        assert_eq!(model.limits()[0].effort, JointLimits::UNKNOWN_EFFORT);
        assert!(Data::new(&model).pose(&model, &[0.3]).is_ok());
        let torque = torque_control(&model).unwrap_err();
        let drive = [JointDrive::TORQUE];
        let simulated = RigidBodySimulation::new(&model, &drive, &[0.0]).unwrap_err();
        for error in [torque, simulated] {
            assert!(
                matches!(&error, Error::UnknownEffort { joint } if joint == "hinge"),
                "{error}"
            );
        }
        let effort = LimitOverride { effort: Some(50.0), ..LimitOverride::default() };
        let limits = vec![("hinge".to_owned(), effort)];
        let description = Description { limits, ..Description::default() };
        let model = Model::from_urdf(&urdf(limit), &description).unwrap();
        assert!(torque_control(&model).is_ok());
    }
    let effort = LimitOverride { effort: Some(0.0), ..LimitOverride::default() };
    let limits = vec![("hinge".to_owned(), effort)];
    let said = Model::from_urdf(&urdf(""), &Description { limits, ..Description::default() });
    assert!(matches!(said, Err(Error::Limit { what: "effort", .. })));
}

#[test]
fn unusable_limit_errors_are_recognisable() {
    let text = urdf(r#"effort="1""#).replace(r#"velocity="1""#, r#"velocity="0""#);
    let error = Model::from_urdf(&text, &Description::default()).unwrap_err();
    assert!(error.is_unusable_limit() && !error.to_string().contains("::"), "{error}");
    let error = Model::from_urdf("<robot/>", &Description::default()).unwrap_err();
    assert!(!error.is_unusable_limit());
}

#[test]
fn utf_16_is_named() {
    let text = urdf(r#"effort="1""#);
    let (little, big): (Vec<u8>, Vec<u8>) = (
        text.encode_utf16().flat_map(u16::to_le_bytes).collect(),
        text.encode_utf16().flat_map(u16::to_be_bytes).collect(),
    );
    let marked = [&[0xff, 0xfe][..], &little].concat();
    for (number, bytes) in [marked, little, big].into_iter().enumerate() {
        let name = format!("whole_body_utf16_{}_{number}.urdf", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::write(&path, bytes).unwrap();
        let error = Model::from_urdf_file(&path, &Description::default()).unwrap_err();
        std::fs::remove_file(&path).unwrap();
        let Error::InFile { source, .. } = &error else { panic!("{error}") };
        let encoding = UrdfError::Encoding { found: "UTF-16" };
        assert!(matches!(&**source, Error::Urdf(fault) if *fault == encoding), "{error}");
        assert!(error.to_string().contains("UTF-8"), "{error}");
    }
}
