//! Effects of a description on a URDF.

use approx::assert_abs_diff_eq;
use nalgebra::{DMatrix, Isometry3, Matrix6xX, Vector3};
use proptest::prelude::*;
use whole_body::robot::{
    AddedFrame, InertiaFault, JointFriction, JointKind, LimitOverride, MissingAcceleration,
    UnusableLimits, Warning,
};
use whole_body::{Axes, Base, Data, Description, Model};

use crate::support::{Kind, Robot, jacobian, pose, robots_of, states};

const TWO_ARMS: &str = include_str!("../golden/two_arms.urdf");
const MOCA: &str = include_str!("../../examples/urdf/moca.urdf");

fn read(urdf: &str, description: &Description) -> Model {
    Model::from_urdf(urdf, description).unwrap()
}

fn names(model: &Model) -> Vec<&str> {
    model.joints().iter().map(|joint| joint.name.as_str()).collect()
}

#[test]
fn joints_follow_the_base_in_textual_order() {
    let model = read(TWO_ARMS, &Description { base: Base::Planar, ..Description::default() });
    let expected = [
        "base_x",
        "base_y",
        "base_yaw",
        "lift",
        "left_arm1",
        "left_arm2",
        "left_arm3",
        "left_arm4",
        "left_arm5",
        "left_arm6",
        "left_finger1",
        "right_arm1",
        "right_arm2",
        "right_arm3",
        "right_arm4",
        "right_arm5",
        "right_arm6",
        "right_finger1",
        "left_wheel",
        "right_wheel",
    ];
    assert_eq!(names(&model), expected);
    assert_eq!((model.position_count(), model.velocity_count()), (20, 20));
    assert_eq!(model.velocity_names()[3], "lift");
    let mimics: Vec<_> = model.mimic_joints().iter().map(|mimic| mimic.name.as_str()).collect();
    assert_eq!(mimics, ["left_finger2", "right_finger2"]);
    let leader = model.joint(model.mimic_joints()[1].follows).unwrap();
    assert_eq!((leader.name.as_str(), leader.kind), ("right_finger1", JointKind::Prismatic));

    let floating = read(TWO_ARMS, &Description { base: Base::Floating, ..Description::default() });
    assert_eq!((floating.position_count(), floating.velocity_count()), (24, 23));
    assert_eq!(floating.joints()[0].kind, JointKind::Floating);
    assert_eq!(floating.velocity_names()[5], "floating_base.wz");
    let lift = floating.joint(floating.joint_id("lift").unwrap()).unwrap();
    assert_eq!((lift.position_index, lift.velocity_index), (7, 6));
}

#[test]
fn tips_and_root_restrict_what_moves() {
    let description = Description {
        root: Some("panda_link0".into()),
        tips: vec!["panda_tcp".into()],
        joints: (1..8).map(|number| format!("panda_joint{number}")).collect(),
        locked: vec![("panda_finger_joint1".into(), 0.03)],
        ..Description::default()
    };
    let model = read(MOCA, &description);
    assert_eq!(model.velocity_count(), 7);
    assert!(model.mimic_joints().is_empty(), "a locked leader locks its follower");
    let q = model.neutral();
    let apart = |finger: &str| {
        let tool = pose(&model, &q, model.frame_id("panda_hand").unwrap());
        let finger = pose(&model, &q, model.frame_id(finger).unwrap());
        (tool.inverse() * finger).translation.vector.y.abs()
    };
    assert_abs_diff_eq!(apart("panda_leftfinger"), 0.03, epsilon = 1e-12);
    assert_abs_diff_eq!(apart("panda_rightfinger"), 0.03, epsilon = 1e-12);
    assert!(model.frame_id("base_link").is_err(), "what is above the root is left out");
    let tcp = model.frame_id("panda_tcp").unwrap();
    assert_eq!(model.moved_by(tcp).unwrap().collect::<Vec<_>>(), [6, 5, 4, 3, 2, 1, 0]);
    let still = model.frame_id("panda_link0").unwrap();
    assert_eq!(model.moved_by(still).unwrap().count(), 0);
}

#[test]
fn locked_joint_equals_a_fixed_one() {
    let free = read(TWO_ARMS, &Description::default());
    let locked = vec![("left_arm3".to_owned(), 0.7), ("left_finger2".to_owned(), 0.01)];
    let locked = read(TWO_ARMS, &Description { locked, ..Description::default() });
    let place = free.joint(free.joint_id("left_arm3").unwrap()).unwrap().velocity_index;
    let mut q: Vec<_> = (0..free.velocity_count()).map(|index| 0.01 * index as f64).collect();
    q[place] = 0.7;
    let mut fewer = q.clone();
    fewer.remove(place);
    for name in ["left_arm6_link", "right_arm6_link", "left_finger1_link"] {
        let [frame, other] = [&free, &locked].map(|model| model.frame_id(name).unwrap());
        assert_abs_diff_eq!(pose(&free, &q, frame), pose(&locked, &fewer, other), epsilon = 1e-12);
        let expected = jacobian(&free, &q, frame, Axes::World).remove_column(place);
        let found = jacobian(&locked, &fewer, other, Axes::World);
        assert_abs_diff_eq!(
            found,
            Matrix6xX::from_columns(&expected.column_iter().collect::<Vec<_>>()),
            epsilon = 1e-12
        );
    }
    assert_eq!(locked.mimic_joints().len(), 1, "a follower may be locked as well");
}

#[test]
fn locked_joint_moves_its_mass_along() {
    let free = read(TWO_ARMS, &Description::default());
    let locked = vec![("left_arm3".to_owned(), 0.7), ("right_finger1".to_owned(), 0.02)];
    let locked = read(TWO_ARMS, &Description { locked, ..Description::default() });
    let place = |name: &str| free.joint(free.joint_id(name).unwrap()).unwrap().velocity_index;
    let (arm, finger) = (place("left_arm3"), place("right_finger1"));
    let mut q: Vec<_> = (0..free.velocity_count()).map(|index| 0.01 * index as f64).collect();
    (q[arm], q[finger]) = (0.7, 0.02);
    let still = |index: &usize| *index != arm && *index != finger;
    let without = |values: &[f64]| -> Vec<f64> {
        (0..values.len()).filter(still).map(|index| values[index]).collect()
    };
    let at_rest = |model: &Model, q: &[f64]| {
        let mut torques = vec![0.0; model.velocity_count()];
        let mut data = Data::new(model);
        let mut posed = data.pose(model, q).unwrap();
        posed.gravity_into(&mut torques).unwrap();
        (torques, posed.potential_energy())
    };
    let (expected, energy) = at_rest(&free, &q);
    let (torques, locked_energy) = at_rest(&locked, &without(&q));
    assert_abs_diff_eq!(torques[..], without(&expected)[..], epsilon = 1e-11);
    assert_abs_diff_eq!(locked_energy, energy, epsilon = 1e-11);
}

#[test]
fn origins_move_what_they_carry() {
    let moved = Isometry3::new(Vector3::new(0.0, 0.3, 0.2), Vector3::new(0.4, 0.0, 0.0));
    let origins = vec![("left_mount".to_owned(), moved)];
    let model = read(TWO_ARMS, &Description { origins, ..Description::default() });
    let q = model.neutral();
    let [torso, base] = ["torso", "left_base"].map(|name| model.frame_id(name).unwrap());
    let relative = Data::new(&model).pose(&model, &q).unwrap().relative_pose(torso, base).unwrap();
    assert_abs_diff_eq!(relative, moved, epsilon = 1e-12);
}

#[test]
fn frames_stand_on_links_and_on_frames() {
    let shift = |z: f64| Isometry3::translation(0.0, 0.0, z);
    let frame =
        |name: &str, on: &str| AddedFrame { name: name.into(), on: on.into(), pose: shift(0.1) };
    let described = |last: AddedFrame| {
        let frames = vec![frame("tool", "panda_hand"), frame("tip", "tool"), last];
        Description { frames, ..Description::default() }
    };
    let model = read(MOCA, &described(frame("needle", "tip")));
    let mut data = Data::new(&model);
    let posed = data.pose(&model, &model.neutral()).unwrap();
    let [tool, needle] = ["panda_hand", "needle"].map(|name| model.frame_id(name).unwrap());
    assert_abs_diff_eq!(posed.relative_pose(tool, needle).unwrap(), shift(0.3), epsilon = 1e-12);
    assert_eq!(model.frame_name(needle).unwrap(), "needle");
    assert!(Model::from_urdf(MOCA, &described(frame("tip", "tool"))).is_err());
    assert!(Model::from_urdf(MOCA, &described(frame("new", "nowhere"))).is_err());
}

#[test]
fn limits_come_from_the_urdf_and_the_description() {
    let limits = vec![
        (
            "panda_joint2".to_owned(),
            LimitOverride {
                position: Some((-1.0, 1.5)),
                acceleration: Some(7.5),
                ..LimitOverride::default()
            },
        ),
        ("base_x".to_owned(), LimitOverride { velocity: Some(0.5), ..LimitOverride::default() }),
    ];
    let root = Some("base_link".to_owned());
    let model =
        read(MOCA, &Description { base: Base::Planar, root, limits, ..Description::default() });
    let of = |name: &str| {
        model.limits()[model.joint(model.joint_id(name).unwrap()).unwrap().velocity_index]
    };
    let first = of("panda_joint1");
    assert_eq!(
        (first.lower, first.upper, first.velocity, first.effort),
        (-2.8973, 2.8973, 2.175, 87.0)
    );
    assert_eq!((first.acceleration, first.jerk), (2.175 / 0.25, f64::INFINITY));
    let second = of("panda_joint2");
    assert_eq!((second.lower, second.upper, second.acceleration), (-1.0, 1.5, 7.5));
    assert_eq!((of("base_x").velocity, of("base_x").acceleration), (0.5, 2.0));
    assert_eq!((of("base_y").velocity, of("base_y").acceleration), (f64::INFINITY, f64::INFINITY));
    let defaults: Vec<_> = model
        .default_accelerations()
        .iter()
        .map(|joint| model.joint(*joint).unwrap().name.as_str())
        .collect();
    assert!(defaults.contains(&"panda_joint1") && defaults.contains(&"base_x"));
    assert!(!defaults.contains(&"panda_joint2") && !defaults.contains(&"base_y"));
    let missing_acceleration = MissingAcceleration::Unlimited;
    let model = read(MOCA, &Description { missing_acceleration, ..Description::default() });
    assert!(model.default_accelerations().is_empty());
    assert!(model.limits().iter().all(|limits| limits.acceleration == f64::INFINITY));
}

#[test]
fn description_completes_limits_missing_in_the_urdf() {
    let limit = "<limit lower=\"-1.7628\" upper=\"1.7628\" velocity=\"2.175\" effort=\"87\"/>";
    assert_eq!(MOCA.matches(limit).count(), 1);
    let known = LimitOverride {
        position: Some((-1.0, 1.0)),
        velocity: Some(2.0),
        effort: Some(50.0),
        ..LimitOverride::default()
    };
    let limits = vec![("panda_joint2".to_owned(), known)];
    let model =
        read(&MOCA.replacen(limit, "", 1), &Description { limits, ..Description::default() });
    let second = model.joint(model.joint_id("panda_joint2").unwrap()).unwrap();
    let limits = model.limits()[second.velocity_index];
    assert_eq!((limits.lower, limits.velocity, limits.effort), (-1.0, 2.0, 50.0));
}

#[test]
fn acceleration_deceleration_and_jerk_count() {
    let text = MOCA.replacen(
        "velocity=\"2.175\"",
        "velocity=\"2.175\" acceleration=\"9\" deceleration=\"8\" jerk=\"900\"",
        1,
    );
    let model =
        read(&text, &Description { tips: vec!["panda_tcp".into()], ..Description::default() });
    let limits = model.limits()[3];
    assert_eq!((limits.acceleration, limits.jerk), (8.0, 900.0));
}

#[test]
fn limit_missing_in_newer_urdf_means_unlimited() {
    let urdf = |version: &str| {
        format!(
            "<robot name=\"r\" version=\"{version}\"><link name=\"a\"/><link name=\"b\"/>\
             <joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>\
             <limit velocity=\"2\"/></joint></robot>"
        )
    };
    let model = read(&urdf("1.2"), &Description::default());
    assert_eq!(
        (model.limits()[0].lower, model.limits()[0].effort),
        (f64::NEG_INFINITY, f64::INFINITY)
    );
    assert!(Model::from_urdf(&urdf("1.0"), &Description::default()).is_err());
}

#[test]
fn ignored_unusable_limits_are_warned_about() {
    let text = MOCA.replacen(
        "lower=\"-2.8973\" upper=\"2.8973\" velocity=\"2.175\"",
        "lower=\"0\" upper=\"0\" velocity=\"0\"",
        1,
    );
    assert!(Model::from_urdf(&text, &Description::default()).is_err());
    let unusable_limits = UnusableLimits::Ignore;
    let model = read(&text, &Description { unusable_limits, ..Description::default() });
    let ignored = |limit: &str| {
        let own = |warning: &&Warning| matches!(warning, Warning::LimitIgnored { joint, limit: which, .. } if joint == "panda_joint1" && *which == limit);
        model.warnings().iter().filter(own).count()
    };
    assert_eq!((ignored("range of positions"), ignored("velocity"), ignored("effort")), (1, 1, 0));
    let limits = model.limits()[3];
    assert_eq!(
        (limits.upper, limits.velocity, limits.effort),
        (f64::INFINITY, f64::INFINITY, 87.0)
    );
}

#[test]
fn inertias_that_are_none_are_named() {
    let triangle = MOCA.replacen(
        "ixx=\"0.001\" iyy=\"0.0025\" izz=\"0.0017\"",
        "ixx=\"0.001\" iyy=\"0.0085\" izz=\"0.0017\"",
        1,
    );
    let negative = MOCA.replacen("ixx=\"0.001\"", "ixx=\"-0.001\"", 1);
    let massless = MOCA.replacen("<mass value=\"0.73\"/>", "<mass value=\"0\"/>", 1);
    for (text, expected) in [(triangle, 0), (negative, 1), (massless, 2)] {
        assert_ne!(text, MOCA);
        let model = read(&text, &Description::default());
        let [Warning::NotAnInertia { link, fault, line }] = model.warnings() else {
            panic!("{:?}", model.warnings());
        };
        let found = match fault {
            InertiaFault::Triangle(_) => 0,
            InertiaFault::NegativeMoment(_) => 1,
            InertiaFault::NoMass => 2,
        };
        assert_eq!((link.as_str(), found), ("panda_hand", expected));
        let line = text.lines().nth(*line - 1).unwrap();
        assert!(line.contains("<inertial>"), "{line}");
    }
    assert!(read(MOCA, &Description::default()).warnings().is_empty());
}

#[test]
fn friction_acts_only_on_described_joints() {
    let friction =
        (1..8).zip(JointFriction::PANDA).map(|(number, own)| (format!("panda_joint{number}"), own));
    let model = read(MOCA, &Description { friction: friction.collect(), ..Description::default() });
    let mut data = Data::new(&model);
    let mut out = vec![0.0; model.velocity_count()];
    for sign in [-1.0, 1.0] {
        let v = vec![0.5 * sign; model.velocity_count()];
        let moving = data.pose(&model, &model.neutral()).unwrap().moving(&v).unwrap();
        moving.friction_into(&mut out).unwrap();
        assert_eq!(out[..3], [0.0; 3]);
        assert!(out[3..10].iter().all(|torque| torque * sign > 0.05));
    }
    // The expected value of the first joint is φ₁ (1/(1+exp(−φ₂(0.5+φ₃))) − 1/(1+exp(−φ₂φ₃))), computed in Python.
    assert_abs_diff_eq!(out[3], 0.213_075_758_660_284, epsilon = 1e-12);
}

#[test]
fn a_mimic_of_a_mimic_follows_the_first() {
    let joint = |name: &str, parent: &str, child: &str, mimic: &str| {
        format!(
            "<link name=\"{child}\"/><joint name=\"{name}\" type=\"continuous\"><parent \
             link=\"{parent}\"/><child link=\"{child}\"/><axis xyz=\"0 0 1\"/>{mimic}</joint>"
        )
    };
    // The last joint follows the middle one, which is behind it in the text.
    let urdf = [
        "<robot name=\"r\"><link name=\"world\"/>".to_owned(),
        joint("last", "world", "c", "<mimic joint=\"middle\" multiplier=\"-0.5\" offset=\"0.3\"/>"),
        joint("middle", "world", "b", "<mimic joint=\"first\" multiplier=\"2\" offset=\"0.1\"/>"),
        joint("first", "world", "a", ""),
        "</robot>".to_owned(),
    ]
    .concat();
    let free = read(&urdf, &Description::default());
    assert_eq!(names(&free), ["first"]);
    let last = &free.mimic_joints()[0];
    assert_eq!((last.name.as_str(), last.multiplier), ("last", -1.0));
    assert_abs_diff_eq!(last.offset, 0.25, epsilon = 1e-15);
    let locked = vec![("first".to_owned(), 0.4)];
    let locked = read(&urdf, &Description { base: Base::Planar, locked, ..Description::default() });
    for (model, q) in [(free, vec![0.4]), (locked, vec![0.0; 3])] {
        for (link, angle) in [("b", 0.9), ("c", -0.15)] {
            let pose = pose(&model, &q, model.frame_id(link).unwrap());
            assert_abs_diff_eq!(pose.rotation.euler_angles().2, angle, epsilon = 1e-12);
        }
    }
}

fn with_mimics() -> impl Strategy<Value = Robot> {
    robots_of(&[Kind::Prismatic, Kind::Revolute, Kind::Mimic, Kind::Mimic])
}

proptest! {
    #[test]
    fn mimic_joint_equals_a_constrained_free_joint((robot, state) in with_mimics().prop_flat_map(states)) {
        let model = robot.model();
        let free = Model::from_urdf(&without_mimics(&robot.urdf()), &robot.description()).unwrap();
        // The expansion maps q̇ of the independent joints to q̇ of all joints.
        let mut expansion = DMatrix::zeros(free.velocity_count(), model.velocity_count());
        let mut q = free.neutral();
        for joint in model.joints() {
            let own = free.joint(free.joint_id(&joint.name).unwrap()).unwrap();
            for entry in 0..joint.kind.velocities() {
                expansion[(own.velocity_index + entry, joint.velocity_index + entry)] = 1.0;
            }
            for entry in 0..joint.kind.positions() {
                q[own.position_index + entry] = state.q[joint.position_index + entry];
            }
        }
        for mimic in model.mimic_joints() {
            let own = free.joint(free.joint_id(&mimic.name).unwrap()).unwrap();
            let leader = model.joint(mimic.follows).unwrap();
            expansion[(own.velocity_index, leader.velocity_index)] = mimic.multiplier;
            q[own.position_index] = mimic.multiplier * state.q[leader.position_index] + mimic.offset;
        }
        for (frame, name) in model.frames() {
            let other = free.frame_id(name).unwrap();
            assert_abs_diff_eq!(pose(&model, &state.q, frame), pose(&free, &q, other), epsilon = 1e-11);
            let expected = jacobian(&free, &q, other, Axes::World) * &expansion;
            assert_abs_diff_eq!(jacobian(&model, &state.q, frame, Axes::World), expected, epsilon = 1e-10);
        }
        let mass = |model: &Model, q: &[f64]| {
            let mut out = DMatrix::zeros(model.velocity_count(), model.velocity_count());
            Data::new(model).pose(model, q).unwrap().mass_matrix_into(&mut out).unwrap();
            out
        };
        let expected = expansion.transpose() * mass(&free, &q) * &expansion;
        let size = expected.amax().max(1.0);
        assert_abs_diff_eq!(mass(&model, &state.q), expected, epsilon = 1e-11 * size);
    }

    #[test]
    fn the_order_of_elements_does_not_matter((robot, state) in robots_of(&[Kind::Revolute, Kind::Fixed, Kind::Prismatic]).prop_flat_map(states)) {
        // Links and joints are written from the last to the first. Joints keep their order along each path; branches
        // change theirs.
        let urdf = robot.urdf();
        let body = urdf.trim_start_matches("<robot name=\"random\">\n").trim_end_matches("</robot>\n");
        let mut elements: Vec<_> = body.split_inclusive("</joint>\n").flat_map(|part| part.split_inclusive("</link>\n")).collect();
        elements.reverse();
        let reversed = format!("<robot name=\"random\">\n{}</robot>\n", elements.concat());
        let [model, other] = [&urdf, &reversed].map(|text| Model::from_urdf(text, &robot.description()).unwrap());
        let mut q = other.neutral();
        for joint in model.joints() {
            let own = other.joint(other.joint_id(&joint.name).unwrap()).unwrap();
            for entry in 0..joint.kind.positions() {
                q[own.position_index + entry] = state.q[joint.position_index + entry];
            }
        }
        for (frame, name) in model.frames() {
            let mirrored = other.frame_id(name).unwrap();
            assert_abs_diff_eq!(pose(&model, &state.q, frame), pose(&other, &q, mirrored), epsilon = 1e-12);
        }
        let [mut one, mut two] = [Data::new(&model), Data::new(&other)];
        let energies = [one.pose(&model, &state.q).unwrap().potential_energy(), two.pose(&other, &q).unwrap().potential_energy()];
        assert_abs_diff_eq!(energies[0], energies[1], epsilon = 1e-9);
    }
}

/// The text without all `<mimic …/>`.
fn without_mimics(urdf: &str) -> String {
    let mut parts = urdf.split("<mimic");
    let first = parts.next().unwrap().to_owned();
    parts.fold(first, |text, part| text + part.split_once("/>").unwrap().1)
}
