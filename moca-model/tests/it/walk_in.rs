//! A person who works with the robot walks into it while it moves.

use hrsw::{BodyRegion, Capsule, ContactLimits, proximity};
use moca_model::whole_body::Data;
use moca_model::{
    Controller, ControllerSettings, HeldObject, MOCA_HOME, SafetySettings, SimulatedRobot,
};
use nalgebra::{DMatrix, Isometry3, Matrix3, Point3, Vector3};
use rand::Rng;
use rand_chacha::rand_core::SeedableRng;
use vision_models::{Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction, Tool};

use crate::shared::MOCA;

const PERIOD: f64 = 1e-3;
/// Ticks between two camera frames at 20 Hz.
const FRAME: usize = 50;
/// The robot comes nearer no faster than this: what happens then is the person's doing \[m/s\].
const STANDS: f64 = 0.01;

/// A person of 1.75 m with the hands before the trunk: place in the person's frame \[m\].
const JOINTS: [(Body25, [f64; 3]); 15] = [
    (Body25::Nose, [0.1, 0.0, 1.6]),
    (Body25::Neck, [0.0, 0.0, 1.43]),
    (Body25::MidHip, [0.0, 0.0, 0.93]),
    (Body25::RightShoulder, [0.0, -0.2, 1.43]),
    (Body25::LeftShoulder, [0.0, 0.2, 1.43]),
    (Body25::RightElbow, [0.12, -0.25, 1.15]),
    (Body25::LeftElbow, [0.12, 0.25, 1.15]),
    (Body25::RightWrist, [0.35, -0.1, 1.1]),
    (Body25::LeftWrist, [0.35, 0.1, 1.1]),
    (Body25::RightHip, [0.0, -0.1, 0.93]),
    (Body25::LeftHip, [0.0, 0.1, 0.93]),
    (Body25::RightKnee, [0.02, -0.1, 0.5]),
    (Body25::LeftKnee, [0.02, 0.1, 0.5]),
    (Body25::RightAnkle, [0.0, -0.1, 0.07]),
    (Body25::LeftAnkle, [0.0, 0.1, 0.07]),
];

/// From, to, beyond, radius \[m\], region.
const PARTS: [(Body25, Body25, f64, f64, BodyRegion); 12] = [
    (Body25::Neck, Body25::Nose, 0.0, 0.13, BodyRegion::Face),
    (Body25::Neck, Body25::MidHip, 0.0, 0.15, BodyRegion::Chest),
    (Body25::LeftShoulder, Body25::RightShoulder, 0.0, 0.08, BodyRegion::Back),
    (Body25::LeftHip, Body25::RightHip, 0.0, 0.12, BodyRegion::Pelvis),
    (Body25::LeftShoulder, Body25::LeftElbow, 0.0, 0.06, BodyRegion::UpperArm),
    (Body25::RightShoulder, Body25::RightElbow, 0.0, 0.06, BodyRegion::UpperArm),
    (Body25::LeftElbow, Body25::LeftWrist, 0.15, 0.06, BodyRegion::Forearm),
    (Body25::RightElbow, Body25::RightWrist, 0.15, 0.06, BodyRegion::Forearm),
    (Body25::LeftHip, Body25::LeftKnee, 0.0, 0.09, BodyRegion::Thigh),
    (Body25::RightHip, Body25::RightKnee, 0.0, 0.09, BodyRegion::Thigh),
    (Body25::LeftKnee, Body25::LeftAnkle, 0.05, 0.08, BodyRegion::LowerLeg),
    (Body25::RightKnee, Body25::RightAnkle, 0.05, 0.08, BodyRegion::LowerLeg),
];

fn capsules(world_from_person: &Isometry3<f64>) -> Vec<Capsule> {
    let place = |joint: Body25| {
        let (_, place) = JOINTS.iter().find(|(other, _)| *other == joint).unwrap();
        (world_from_person * Point3::from(*place)).coords
    };
    let capsule = |&(from, to, beyond, radius, _): &(Body25, Body25, f64, f64, BodyRegion)| {
        let (from, to) = (place(from), place(to));
        Capsule::new(from, to + (to - from).normalize() * beyond, radius).unwrap()
    };
    PARTS.iter().map(capsule).collect()
}

fn percept(time: f64, world_from_person: &Isometry3<f64>) -> Percept {
    let mut body = Body::default();
    for (joint, place) in JOINTS {
        let position = world_from_person * Point3::from(place);
        body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
    }
    let action = Action::Using(Tool::Drill);
    let action = Some(RecognisedAction { action, confidence: Confidence::ONE });
    Percept { time, body: Some(body), action, surface: None }
}

/// What the episodes came to.
#[derive(Debug, Default)]
struct Count {
    /// Parts that were touched, whoever moved.
    touched: usize,
    /// Parts that were touched while the robot came nearer, in the regime of force limiting.
    by_robot: usize,
    /// The largest share of the region's force that such a contact reached.
    worst: f64,
    /// Heads that were touched by a robot that came nearer.
    heads: usize,
}

fn walk_in(seed: u64, count: &mut Count) {
    let mut draw = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let model = MOCA.clone();
    let mut robot = SimulatedRobot::new(&model, &MOCA_HOME).unwrap();
    let hessian = Matrix3::from_diagonal(&Vector3::new(10.0, 5.0, 7.0));
    let best = Vector3::new(0.35, -0.1, 1.1);
    let comfort = ergo_map::ErgonomicsQuadratic::new(
        hessian,
        -(hessian * best),
        0.5 * best.dot(&(hessian * best)),
    );
    let settings = ControllerSettings::default();
    let mut controller =
        Controller::new(model.clone(), comfort.unwrap(), settings, &MOCA_HOME).unwrap();
    controller.hold(HeldObject::default()).unwrap();

    // They stand before the robot, work, and walk into it from there, at some speed and angle.
    let tool = robot.position()[0] + 0.3;
    let distance = draw.random_range(0.9..1.3);
    let aside: f64 = draw.random_range(-0.4..0.4);
    let mut at = Vector3::new(tool + distance, aside, 0.0);
    let walk: f64 = draw.random_range(0.05..0.8);
    let towards = std::f64::consts::PI + draw.random_range(-0.5..0.5);
    let heading = std::f64::consts::PI + draw.random_range(-0.6..0.6);
    let begins = draw.random_range(1.2..1.8);
    let mut speed = 0.0;
    let limits = ContactLimits::default();
    let mut data = Data::new(&model);
    let bodies = SafetySettings::default().bodies;
    let mut before: Vec<f64> = Vec::new();
    let mut placed: Vec<Capsule> = Vec::new();
    for tick in 0..3500_usize {
        #[expect(clippy::cast_precision_loss, reason = "an episode lasts seconds")]
        let now = tick as f64 * PERIOD;
        let pose = Isometry3::new(at, Vector3::z() * heading);
        if tick % FRAME == 0 {
            controller.observe(&percept(now, &pose)).unwrap();
        }
        controller.feel(0.0);
        let command = controller.step(now, robot.position()).unwrap();
        assert!(command.outcome.is_optimal());
        let velocity = command.joint_velocity.clone();
        let limited = controller.safety().contact_speed() > 0.0;

        let person = capsules(&pose);
        let posed = data.pose(&model, robot.position()).unwrap();
        let links: Vec<_> = bodies.iter().map(|body| model.frame_id(&body.link).unwrap()).collect();
        let now_placed: Vec<Capsule> = bodies
            .iter()
            .zip(&links)
            .map(|(body, &link)| body.capsule.placed(&posed.world_from(link).unwrap()))
            .collect();
        let mut distances = Vec::new();
        for (i, body) in now_placed.iter().enumerate() {
            for (j, part) in person.iter().enumerate() {
                let near = proximity(body, part);
                let index = distances.len();
                distances.push(near.distance);
                let touches =
                    before.get(index).is_some_and(|last| *last > 0.0 && near.distance <= 0.0);
                if !touches {
                    continue;
                }
                count.touched += 1;
                // By the robot's own motion in the last tick, the person standing.
                let moved = proximity(&placed[i], part).distance;
                let robot_speed = (moved - near.distance) / PERIOD;
                if robot_speed <= STANDS {
                    continue;
                }
                let region = PARTS[j].4;
                let Some(limit) = limits.of(region) else {
                    count.heads += 1;
                    continue;
                };
                if !limited {
                    continue;
                }
                let relative = (before[index] - near.distance) / PERIOD;
                let mass = effective_mass(robot.position(), links[i], &near.on_first, &near.normal);
                count.by_robot += 1;
                count.worst = count.worst.max(limit.force_at(relative, mass) / limit.force);
            }
        }
        (before, placed) = (distances, now_placed);
        robot.step(&velocity, PERIOD).unwrap();
        if now > begins {
            speed = f64::min(speed + 1.0 * PERIOD, walk);
        }
        at += Vector3::new(towards.cos(), towards.sin(), 0.0) * speed * PERIOD;
    }
}

/// 1/(nᵀ J M⁻¹ Jᵀ n) of a point of a link, by the mass matrix and differences of its place \[kg\].
fn effective_mass(
    q: &[f64],
    link: moca_model::whole_body::FrameId,
    at: &Vector3<f64>,
    n: &Vector3<f64>,
) -> f64 {
    let model = MOCA.clone();
    let mut data = Data::new(&model);
    let n_joints = q.len();
    let local = {
        let pose = data.pose(&model, q).unwrap().world_from(link).unwrap();
        pose.inverse_transform_point(&Point3::from(*at))
    };
    let step = 1e-6;
    let mut row = nalgebra::DVector::zeros(n_joints);
    for joint in 0..n_joints {
        let mut along = |sign: f64| {
            let mut moved = q.to_vec();
            moved[joint] += sign * step;
            let pose = data.pose(&model, &moved).unwrap().world_from(link).unwrap();
            (pose * local).coords.dot(n)
        };
        row[joint] = (along(1.0) - along(-1.0)) / (2.0 * step);
    }
    let mut mass = DMatrix::zeros(n_joints, n_joints);
    data.pose(&model, q).unwrap().mass_matrix_into(&mut mass).unwrap();
    1.0 / row.dot(&mass.cholesky().unwrap().solve(&row))
}

/// `AHQP_CASES=10000 cargo test --release -p moca-model --test it walk_in` for as many as one likes.
#[test]
fn who_walks_into_the_robot_is_touched_as_gently_as_the_region_bears() {
    let cases = std::env::var("AHQP_CASES").ok().and_then(|count| count.parse().ok());
    let mut count = Count::default();
    for seed in 0..cases.unwrap_or(12) {
        walk_in(seed, &mut count);
    }
    assert_eq!(count.heads, 0, "{count:?}");
    assert!(count.worst <= 1.0 + 1e-6, "{count:?}");
    assert!(count.touched > 0, "contacts happen: {count:?}");
    println!("{count:?}");
}
