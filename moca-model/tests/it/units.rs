//! People and robots in other units than metres and radians.

use ergo_map::ErgonomicsQuadratic;
use hrsw_safety::{Fault, FrameFault, SafetyState};
use moca_model::whole_body::control_loop::{
    ControlLoop, JointCommand, JointMeasurement, LoopSettings, ManualClock, Received, RobotSide,
};
use moca_model::{
    Controller, ControllerSettings, Error, LoopController, MOCA_HOME, MOCA_JOINTS, Scene,
    TorqueController, TorqueLoopSettings,
};
use nalgebra::{Matrix3, Point3, Vector3};
use vision_models::{Body, Body25, Confidence, ImpossibleBody, Keypoint, Percept};

use crate::drive::{Drive, percept};
use crate::shared::MOCA;

/// A person who stands at x \[m\], with arms and legs, in other units by a factor.
pub(crate) fn standing(x: f64, scale: f64) -> Body {
    use Body25::{
        LeftAnkle, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip, Neck, RightAnkle,
        RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
    };
    let mut body = Body::default();
    for (joint, y, z) in [
        (Neck, 0.0, 1.45),
        (MidHip, 0.0, 0.93),
        (RightShoulder, 0.19, 1.43),
        (LeftShoulder, -0.19, 1.43),
        (RightElbow, 0.22, 1.12),
        (LeftElbow, -0.22, 1.12),
        (RightWrist, 0.22, 0.86),
        (LeftWrist, -0.22, 0.86),
        (RightHip, 0.1, 0.93),
        (LeftHip, -0.1, 0.93),
        (RightKnee, 0.1, 0.5),
        (LeftKnee, -0.1, 0.5),
        (RightAnkle, 0.1, 0.08),
        (LeftAnkle, -0.1, 0.08),
    ] {
        let position = Point3::new(x, y, z) * scale;
        body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
    }
    body
}

/// The robot drives at 0.2 m/s and more towards a person, who is shown in other units from now on.
#[test]
fn person_in_other_units_is_a_fault() {
    for (scale, expected) in [
        (1e3, FrameFault::Units),
        (1e2, FrameFault::Units),
        (1.0 / 0.0254, FrameFault::Units),
        (1.0 / 0.3048, FrameFault::ImpossibleBody),
        (0.1, FrameFault::ImpossibleBody),
        (0.0, FrameFault::ImpossibleBody),
    ] {
        for beside in [false, true] {
            let mut drive = Drive::fast();
            let person = drive.controller.actual().translation.x + 2.5;
            drive.camera = false;
            drive.person = Some(person);
            let shown = standing(person, scale);
            for frame in 0..20 {
                let (body, others) = if beside {
                    (None, vec![shown.clone()])
                } else {
                    (Some(shown.clone()), vec![])
                };
                let taken = Percept { body, ..percept(drive.time(), None) };
                let error =
                    drive.controller.observe(Scene::from(taken).with_others(&others)).unwrap_err();
                assert!(error.to_string().contains("metres"), "{error}");
                drive.run(0.05);
                assert_eq!(drive.state(), SafetyState::ProtectiveStop, "{scale}, frame {frame}");
            }
            assert_eq!(drive.cause(), Some(Fault::Frame(expected)), "{scale}");
            assert_eq!(drive.fastest(), 0.0);
            assert!(drive.distance() > 0.5);
            // The robot goes on with people in metres.
            drive.camera = true;
            drive.person = Some(person + 20.0);
            drive.run(2.0);
            assert_eq!(drive.state(), SafetyState::Normal);
        }
    }
}

#[test]
fn frames_of_wild_single_joints_are_taken() {
    let clean = standing(2.5, 1.0);
    let origin = Point3::origin();
    assert_eq!(clean.check_possible(&origin, 0.5), Ok(()));
    for joint in Body25::ALL {
        for off in [0.3, 1.0, 5.0, 60.0] {
            for direction in [Vector3::x(), -Vector3::x(), Vector3::y(), Vector3::z()] {
                let mut body = clean.clone();
                let Some(seen) = body.get(joint) else { continue };
                let position = seen.position + direction * off;
                body.set(joint, Some(Keypoint { position, ..seen }));
                assert_eq!(
                    body.check_possible(&origin, 0.5),
                    Ok(()),
                    "{} by {off} m",
                    joint.name()
                );
            }
        }
    }
    // Joints without confidence are checked for their distance, but not for the length of their segments.
    let unsure = |keypoint: Keypoint| Keypoint { confidence: Confidence::ZERO, ..keypoint };
    let feet = standing(2.5, 1.0 / 0.3048);
    let hidden = Body::new(feet.keypoints().map(|keypoint| keypoint.map(unsure)));
    assert_eq!(hidden.check_possible(&origin, 0.5), Ok(()));
    let millimetres = standing(2.5, 1e3);
    let hidden = Body::new(millimetres.keypoints().map(|keypoint| keypoint.map(unsure)));
    let far = hidden.check_possible(&origin, 0.5).unwrap_err();
    assert!(matches!(far, ImpossibleBody::Far { .. }), "{far}");
}

#[test]
fn people_of_every_stature_and_posture_are_possible() {
    for stature in [1.2, 1.5, 1.75, 2.0, 2.3] {
        assert_eq!(standing(3.0, stature / 1.7).check_possible(&Point3::origin(), 0.5), Ok(()));
    }
    // The person is a kilometre from the origin of the odometry, beside the robot.
    let far = standing(1000.0, 1.0);
    assert!(far.check_possible(&Point3::origin(), 0.5).is_err());
    assert_eq!(far.check_possible(&Point3::new(998.0, 0.0, 1.0), 0.5), Ok(()));
}

/// A robot that always measures the same.
struct Stands(Vec<f64>, Vec<f64>, u32);

impl RobotSide for Stands {
    type Error = std::convert::Infallible;

    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, Self::Error> {
        measured.position.clone_from(&self.0);
        measured.velocity.clone_from(&self.1);
        Ok(Received::Fresh)
    }

    fn send(&mut self, _command: &JointCommand) -> Result<(), Self::Error> {
        self.2 += 1;
        Ok(())
    }

    fn halt(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

#[test]
fn joints_in_wrong_units_end_the_loop() {
    let degrees = MOCA_HOME.iter().enumerate();
    let degrees: Vec<f64> =
        degrees.map(|(joint, q)| if joint < 3 { *q } else { q.to_degrees() }).collect();
    let mut millimetres = MOCA_HOME.to_vec();
    millimetres[1] = -2500.0;
    let mut fast = vec![0.0; 10];
    fast[4] = -40.0;
    let home = MOCA_HOME.to_vec();
    let rest = vec![0.0; 10];
    for (position, velocity, joint, unit) in [
        (&degrees, &rest, 4, "radians, not degrees"),
        (&millimetres, &rest, 1, "metres, not millimetres"),
        (&home, &fast, 4, "radians a second, not degrees a second"),
    ] {
        let ergonomics =
            ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
        let controller =
            Controller::new(MOCA.clone(), ergonomics, ControllerSettings::default(), &MOCA_HOME);
        let controller = TorqueController::new(
            controller.unwrap(),
            TorqueLoopSettings::new(moca_model::whole_body::torque::Compensation::BARE),
        );
        let (mut law, _frames) = LoopController::new(controller.unwrap());
        let mut robot = Stands(position.clone(), velocity.clone(), 0);
        let measured = JointMeasurement::at_rest(&MOCA);
        let mut control = ControlLoop::new(LoopSettings::default(), measured).unwrap();
        let ended = control.run(&mut robot, &mut law, &mut ManualClock::default(), || false);
        let error = ended.unwrap_err().to_string();
        assert!(error.contains(MOCA_JOINTS[joint]) && error.contains(unit), "{error}");
        assert_eq!(robot.2, 0, "no command");
    }
    assert!(MOCA.check_units(&MOCA_HOME, &[0.0; 10]).is_ok());
}

#[test]
fn impossibly_fast_person_needs_second_sighting() {
    // Frames come every 0.05 s, in which 12.5 m/s are 0.625 m; 0.03 m are noise.
    for (way, refused) in [(0.1, false), (0.6, false), (0.7, true), (2.0, true), (20.0, true)] {
        let mut drive = Drive::fast();
        let person = drive.controller.actual().translation.x + 4.0;
        drive.camera = false;
        let show = |drive: &mut Drive, place: f64| {
            let body = Some(standing(place, 1.0));
            let taken = drive.controller.observe(&Percept { body, ..percept(drive.time(), None) });
            drive.run(0.05);
            taken
        };
        for _ in 0..20 {
            show(&mut drive, person).unwrap();
        }
        let followed = |drive: &Drive| {
            let person = drive.controller.situation().worker.unwrap();
            person.floor.x
        };
        let before = followed(&drive);
        let taken = show(&mut drive, person + way);
        assert_eq!(
            matches!(taken, Err(Error::Safety(hrsw_safety::Error::BodySpeed { .. }))),
            refused,
            "{way} m: {taken:?}"
        );
        if refused {
            let cause = drive.cause();
            assert_eq!(cause, Some(FrameFault::ImpossibleSpeed.into()), "{way} m");
            assert!((followed(&drive) - before).abs() < 0.01, "{way} m");
        }
        // A person who is seen there again is there.
        show(&mut drive, person + way).unwrap();
    }
}
