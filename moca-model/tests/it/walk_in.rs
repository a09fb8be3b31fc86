//! A person who works with the moving robot walks into it.

use hrsw_safety::{Capsule, proximity};
use moca_model::whole_body::{Data, FrameId};
use moca_model::{
    Controller, ControllerSettings, GraspedObject, MOCA_HOME, MOCA_TOOL, SimulatedRobot,
    moca_safety,
};
use nalgebra::{DMatrix, Isometry3, Matrix3, Point3, Vector3};
use rand::Rng;
use rand_chacha::rand_core::SeedableRng;
use vision_models::{Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction, Tool};

use crate::shared::MOCA;

const PERIOD: f64 = 1e-3;
/// Number of ticks between two camera frames at 20 Hz.
const FRAME: usize = 50;
/// Approach speed of the robot up to which a contact is caused by the person \[m/s\].
const STANDS: f64 = 0.01;
/// Depth in the robot at which a leg or the trunk stops a person who walks \[m\]. A lower leg of 60 kN/m pushes there
/// with 600 N, about the weight of a person.
const STOPPED: f64 = 0.01;

/// A person of 1.75 m with the hands in front of the trunk: places in the person's frame \[m\].
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

/// Limits of a body region in a quasi-static contact: force \[N\], stiffness \[N/m\] and mass \[kg\] of open data for
/// ISO 10218-2:2025, Annex M; `None` for the head, which nothing may touch.
type Bears = Option<[f64; 3]>;
const HEAD: Bears = None;
const CHEST: Bears = Some([140.0, 25e3, 40.0]);
const BACK: Bears = Some([210.0, 35e3, 40.0]);
const PELVIS: Bears = Some([180.0, 25e3, 40.0]);
const UPPER_ARM: Bears = Some([150.0, 30e3, 3.0]);
const FOREARM: Bears = Some([160.0, 40e3, 2.0]);
const THIGH: Bears = Some([220.0, 50e3, 75.0]);
const LOWER_LEG: Bears = Some([130.0, 60e3, 75.0]);

/// From, to, extension, radius \[m\], limits of the region.
const PARTS: [(Body25, Body25, f64, f64, Bears); 12] = [
    (Body25::Neck, Body25::Nose, 0.0, 0.13, HEAD),
    (Body25::Neck, Body25::MidHip, 0.0, 0.15, CHEST),
    (Body25::LeftShoulder, Body25::RightShoulder, 0.0, 0.08, BACK),
    (Body25::LeftHip, Body25::RightHip, 0.0, 0.12, PELVIS),
    (Body25::LeftShoulder, Body25::LeftElbow, 0.0, 0.06, UPPER_ARM),
    (Body25::RightShoulder, Body25::RightElbow, 0.0, 0.06, UPPER_ARM),
    (Body25::LeftElbow, Body25::LeftWrist, 0.15, 0.06, FOREARM),
    (Body25::RightElbow, Body25::RightWrist, 0.15, 0.06, FOREARM),
    (Body25::LeftHip, Body25::LeftKnee, 0.0, 0.09, THIGH),
    (Body25::RightHip, Body25::RightKnee, 0.0, 0.09, THIGH),
    (Body25::LeftKnee, Body25::LeftAnkle, 0.05, 0.08, LOWER_LEG),
    (Body25::RightKnee, Body25::RightAnkle, 0.05, 0.08, LOWER_LEG),
];

/// Returns true for a part of an arm. It gives way when the person walks on.
fn is_arm(&(_, to, ..): &(Body25, Body25, f64, f64, Bears)) -> bool {
    use Body25::{LeftElbow, LeftWrist, RightElbow, RightWrist};
    matches!(to, LeftElbow | RightElbow | LeftWrist | RightWrist)
}

fn capsules(world_from_person: &Isometry3<f64>) -> Vec<Capsule> {
    let place = |joint: Body25| {
        let (_, place) = JOINTS.iter().find(|(other, _)| *other == joint).unwrap();
        (world_from_person * Point3::from(*place)).coords
    };
    let capsule = |&(from, to, beyond, radius, _): &(Body25, Body25, f64, f64, Bears)| {
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

/// Results of the episodes.
#[derive(Debug, Default)]
struct Count {
    /// Number of body parts that were touched, whoever moved.
    touched: usize,
    /// Number of body parts that were touched by an approaching robot under force limiting.
    by_robot: usize,
    /// Largest force of such a contact over the region's limit.
    worst: f64,
    /// Contacts above the limit.
    above: Vec<String>,
    /// Number of heads that were touched by an approaching robot.
    heads: usize,
}

/// A person who stands in front of the robot, works, and walks into it from there.
struct Walker {
    at: Vector3<f64>,
    heading: f64,
    towards: Vector3<f64>,
    /// Time at which the walk begins \[s\].
    begins: f64,
    speed: f64,
    /// Speed that the person walks at \[m/s\].
    walk: f64,
}

impl Walker {
    fn draw(draw: &mut impl Rng, tool: f64) -> Self {
        let distance = draw.random_range(0.9..1.3);
        let aside: f64 = draw.random_range(-0.4..0.4);
        let walk = draw.random_range(0.05..0.8);
        let towards: f64 = std::f64::consts::PI + draw.random_range(-0.5..0.5);
        let heading = std::f64::consts::PI + draw.random_range(-0.6..0.6);
        let begins = draw.random_range(1.2..1.8);
        let at = Vector3::new(tool + distance, aside, 0.0);
        let towards = Vector3::new(towards.cos(), towards.sin(), 0.0);
        Self { at, heading, towards, begins, speed: 0.0, walk }
    }

    fn pose(&self) -> Isometry3<f64> {
        Isometry3::new(self.at, Vector3::z() * self.heading)
    }

    fn step(&mut self, now: f64, stopped: bool) {
        if stopped {
            self.speed = 0.0;
        } else if now > self.begins {
            self.speed = f64::min(self.speed + 1.0 * PERIOD, self.walk);
        }
        self.at += self.towards * self.speed * PERIOD;
    }
}

fn walk_in(seed: u64, count: &mut Count) {
    let mut draw = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let model = MOCA.clone();
    let mut robot = SimulatedRobot::new(&model, &MOCA_HOME).unwrap();
    let hessian = Matrix3::from_diagonal(&Vector3::new(10.0, 5.0, 7.0));
    let best = Vector3::new(0.35, -0.1, 1.1);
    let ergonomics = ergo_map::ErgonomicsQuadratic::new(
        hessian,
        -(hessian * best),
        0.5 * best.dot(&(hessian * best)),
    );
    let settings = ControllerSettings::default();
    let mut controller =
        Controller::new(model.clone(), ergonomics.unwrap(), settings, &MOCA_HOME).unwrap();
    let object = GraspedObject::default();
    controller.grasp(object.clone()).unwrap();

    let mut walker = Walker::draw(&mut draw, robot.position()[0] + 0.3);
    let mut data = Data::new(&model);
    let hand = model.frame_id(MOCA_TOOL).unwrap();
    data.attach(&model, &object.payload(hand)).unwrap();
    let mut bodies: Vec<(FrameId, Capsule)> = moca_safety()
        .bodies
        .iter()
        .map(|body| (model.frame_id(&body.link).unwrap(), body.capsule))
        .collect();
    bodies.push((hand, object.capsule().unwrap()));
    let mut before: Vec<f64> = Vec::new();
    let mut placed: Vec<Capsule> = Vec::new();
    for tick in 0..3500_usize {
        #[expect(clippy::cast_precision_loss, reason = "an episode lasts seconds")]
        let now = tick as f64 * PERIOD;
        let pose = walker.pose();
        if tick % FRAME == 0 {
            controller.observe(percept(now, &pose)).unwrap();
        }
        controller.set_external_force(0.0);
        let command = controller.step(now, robot.position()).unwrap();
        assert!(command.outcome.is_optimal());
        let velocity = command.joint_velocity.clone();
        let limited = controller.safety().contact_speed() > 0.0;

        let person = capsules(&pose);
        let posed = data.pose(&model, robot.position()).unwrap();
        let now_placed: Vec<Capsule> = bodies
            .iter()
            .map(|(link, capsule)| capsule.placed(&posed.world_from(*link).unwrap()))
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
                // The distance after the robot's own motion in the last tick, with the person at rest.
                let moved = proximity(&placed[i], part).distance;
                let robot_speed = (moved - near.distance) / PERIOD;
                if robot_speed <= STANDS {
                    continue;
                }
                let Some([force, stiffness, mass]) = PARTS[j].4 else {
                    count.heads += 1;
                    continue;
                };
                if !limited {
                    continue;
                }
                let relative = (before[index] - near.distance) / PERIOD;
                let place = (bodies[i].0, &near.on_first);
                let robot_mass = effective_mass(&mut data, robot.position(), place, &near.normal);
                let reduced = 1.0 / (1.0 / mass + 1.0 / robot_mass);
                count.by_robot += 1;
                let share = relative * (stiffness * reduced).sqrt() / force;
                if share > 1.0 {
                    count.above.push(format!(
                        "seed {seed}, tick {tick}: body {i} and part {j} at {relative} m/s, of which the \
                         robot's are {robot_speed}, {robot_mass} kg: {share} of the force"
                    ));
                }
                count.worst = count.worst.max(share);
            }
        }
        let mut trunk_and_legs = distances.chunks(PARTS.len()).flat_map(|of_body| {
            of_body
                .iter()
                .zip(&PARTS)
                .filter(|(_, part)| !is_arm(part))
                .map(|(distance, _)| *distance)
        });
        let stopped = trunk_and_legs.any(|distance| distance < -STOPPED);
        (before, placed) = (distances, now_placed);
        robot.step(&velocity, PERIOD).unwrap();
        walker.step(now, stopped);
    }
}

/// 1/(nᵀ J M⁻¹ Jᵀ n) of a point of a link \[world, m\], from the mass matrix and differences of its place \[kg\].
fn effective_mass(
    data: &mut Data,
    q: &[f64],
    (link, at): (FrameId, &Vector3<f64>),
    n: &Vector3<f64>,
) -> f64 {
    let model = &*MOCA;
    let n_joints = q.len();
    let local = {
        let pose = data.pose(model, q).unwrap().world_from(link).unwrap();
        pose.inverse_transform_point(&Point3::from(*at))
    };
    let step = 1e-6;
    let mut row = nalgebra::DVector::zeros(n_joints);
    for joint in 0..n_joints {
        let mut along = |sign: f64| {
            let mut moved = q.to_vec();
            moved[joint] += sign * step;
            let pose = data.pose(model, &moved).unwrap().world_from(link).unwrap();
            (pose * local).coords.dot(n)
        };
        row[joint] = (along(1.0) - along(-1.0)) / (2.0 * step);
    }
    let mut mass = DMatrix::zeros(n_joints, n_joints);
    data.pose(model, q).unwrap().mass_matrix_into(&mut mass).unwrap();
    1.0 / row.dot(&mass.cholesky().unwrap().solve(&row))
}

/// The first case is that of seed `AHQP_FIRST`, or 0. Set the number of cases with `AHQP_CASES=10000 cargo test
/// --release -p moca-model --test it walk_in`.
#[test]
fn walking_into_robot_keeps_contact_limits() {
    let number = |name| std::env::var(name).ok().and_then(|number| number.parse::<u64>().ok());
    let (first, cases) = (number("AHQP_FIRST").unwrap_or(0), number("AHQP_CASES").unwrap_or(12));
    let mut count = Count::default();
    for seed in first..first + cases {
        walk_in(seed, &mut count);
        if (seed + 1).is_multiple_of(500) {
            println!("{}: {count:?}", seed + 1);
        }
    }
    assert_eq!(count.heads, 0, "{count:?}");
    assert!(count.worst <= 1.0 + 1e-6, "{count:?}");
    assert!(count.touched > 0, "contacts happen: {count:?}");
    println!("{count:?}");
}
