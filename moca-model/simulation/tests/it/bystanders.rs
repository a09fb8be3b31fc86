//! People beside the one who works with the robot: their ids, and the speeds that safety counts with.

use ergo_map::ErgonomicsQuadratic;
use hrsw_safety::PersonBody;
use moca_model::{Controller, ControllerSettings, MOCA_HOME, Scene, moca};
use moca_simulation::people::{
    CameraSettings, Facing, Joints, Lead, LedPerson, Perception, Way, Workplace,
};
use nalgebra::{Matrix3, Point2, Point3, Vector3};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use vision_models::{
    Body, Body25, People, PeopleSettings, Percept, PersonId, Tool, TrackerSettings,
};

const PERIOD: f64 = 1e-3;
const FRAME: u32 = 50;
const WORKPLACE: Workplace =
    Workplace { object: Point3::new(0.8, 0.0, 1.0), between: Point3::new(0.5, 0.0, 1.0) };

/// A simulated person, before a camera that loses no joint.
struct Bystander {
    led: LedPerson,
    camera: Perception,
    before: Joints,
}

impl Bystander {
    /// Creates a person who stands on the floor at `from` \[m\], or walks along `way` at 1.2 m/s.
    fn new(id: u64, from: [f64; 2], way: Option<[f64; 2]>) -> Self {
        let [x, y] = way.unwrap_or([-1.0, 0.0]);
        let mut led = LedPerson::new(1.75, Point2::from(from), y.atan2(x)).unwrap();
        if let Some(way) = way {
            let way = Way::Along(way.into());
            led.lead(Lead { way, speed: 1.2, facing: Facing::Way, ..Lead::default() }).unwrap();
        }
        let eyes = [id, id + 100].map(ChaCha8Rng::seed_from_u64);
        let settings = CameraSettings { drop: 0.0, ..CameraSettings::default() };
        let camera = Perception::new(PersonId::new(id), settings, 0.0, Tool::Drill, eyes);
        Self { before: led.person().joints(), led, camera }
    }

    fn advance(&mut self) {
        self.before = self.led.person().joints();
        self.led.advance(PERIOD, &WORKPLACE);
    }

    fn look(&mut self, time: f64) -> Body {
        self.camera.look(time, self.led.person(), true).unwrap().body.unwrap()
    }

    /// The true joint that is nearest to a place \[m\], how far it is \[m\], and its velocity \[m/s\].
    fn nearest(&self, place: &Vector3<f64>) -> (Body25, f64, Vector3<f64>) {
        let now = self.led.person().joints();
        let joints = Body25::ALL.into_iter().zip(now.iter().zip(&self.before));
        let joints = joints.map(|(joint, (now, before))| {
            (joint, (now.coords - place).norm(), (now - before) / PERIOD)
        });
        joints.min_by(|one, other| one.1.total_cmp(&other.1)).unwrap()
    }
}

/// The controller of a robot that stands at home, where nobody works with it.
fn controller() -> Controller {
    let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
    Controller::new(moca().unwrap(), ergonomics, ControllerSettings::default(), &MOCA_HOME).unwrap()
}

fn nobody(time: f64) -> Percept {
    Percept { time, body: None, action: None, surface: None }
}

/// Shows bystanders to the controller for some frames. `each` sees it after every frame.
fn watch(
    people: &mut [Bystander],
    frames: u32,
    mut identify: impl FnMut(f64, Vec<Body>) -> Vec<Body>,
    mut each: impl FnMut(f64, &Controller, &[Bystander]),
) {
    let mut controller = controller();
    for tick in 0..frames * FRAME {
        let time = f64::from(tick) * PERIOD;
        let is_frame = tick.is_multiple_of(FRAME);
        if is_frame {
            let mut bodies: Vec<_> = people.iter_mut().map(|person| person.look(time)).collect();
            bodies.rotate_left((tick / FRAME) as usize % people.len());
            let bodies = identify(time, bodies);
            controller.observe(Scene::from(nobody(time)).with_others(&bodies)).unwrap();
        }
        controller.step(time, &MOCA_HOME).unwrap();
        if is_frame {
            each(time, &controller, people);
        }
        people.iter_mut().for_each(Bystander::advance);
    }
}

/// The protective distances of all parts of people from a robot at rest in this direction \[m\].
fn protective_distances(controller: &Controller, way: &Vector3<f64>) -> Vec<f64> {
    let separation = &controller.settings().safety.separation;
    let speed = |body: &PersonBody| match body.velocity {
        Some(velocity) => velocity.mean.dot(way) + velocity.uncertainty,
        None => body.assumed_speed,
    };
    let bodies = controller.safety().all_bodies().iter();
    bodies.map(|body| separation.protective_distance(speed(body), 0.0)).collect()
}

#[test]
fn standing_bystanders_need_less_than_unknown_ones() {
    // Somebody else is there after two seconds.
    let known = |time: f64, bodies: Vec<Body>| {
        let id = PersonId::new(if time < 1.99 { 1 } else { 2 });
        bodies.into_iter().map(|body| body.with_id(id)).collect()
    };
    let mut frame = 0;
    watch(&mut [Bystander::new(1, [2.5, 0.0], None)], 42, known, |_, controller, _| {
        let bodies = controller.safety().all_bodies();
        let distances = protective_distances(controller, &-Vector3::x());
        // v_h T_r + C + Z_d + Z_r, at the speeds of walking and reaching.
        let unknown = bodies.iter().map(|body| body.assumed_speed * 0.15 + 0.05 + 0.05 + 0.01);
        let shares: Vec<_> = distances.iter().zip(unknown).map(|(one, all)| one / all).collect();
        let new = shares.iter().filter(|share| (*share - 1.0).abs() < 1e-9).count();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        match frame {
            0..6 => assert_eq!(new, shares.len(), "frame {frame}"),
            10..40 => assert!(mean < 0.8, "frame {frame}: {mean} of an unknown person's"),
            // The person before may still be there.
            40.. => assert_eq!((new, shares.len()), (13, 26), "frame {frame}"),
            _ => {}
        }
        frame += 1;
    });
}

#[test]
fn walking_bystanders_keep_their_true_distance() {
    let mut frames = 0;
    let mut walking = [Bystander::new(1, [6.0, 0.2], Some([-1.0, 0.0]))];
    watch(
        &mut walking,
        70,
        |_, bodies| bodies,
        |time, controller, people| {
            let walks = people[0].led.person().velocity().x < -1.19;
            frames += u32::from(walks);
            let distances = protective_distances(controller, &-Vector3::x());
            let bodies = controller.safety().all_bodies().iter();
            for (body, distance) in bodies.zip(distances).filter(|_| walks) {
                let (joint, _, velocity) = people[0].nearest(body.capsule.start());
                let least = -velocity.x * 0.15 + 0.05 + 0.05 + 0.01;
                let name = joint.name();
                assert!(distance >= least, "{time} s: {name}, {distance} m of {least} m");
            }
        },
    );
    assert!(frames > 30, "{frames} frames of walking");
}

/// Two people walk past each other, 0.3 m apart, and the camera's tracker names them.
#[test]
fn crossing_people_keep_ids_and_speeds() {
    let mut tracker = People::new(PeopleSettings::default(), TrackerSettings::default()).unwrap();
    let mut crossing = [
        Bystander::new(1, [3.0, -2.4], Some([0.0, 1.0])),
        Bystander::new(2, [3.3, 2.4], Some([0.0, -1.0])),
    ];
    let (mut nearest, mut measured) = (f64::INFINITY, 0);
    let identify = |time: f64, bodies: Vec<Body>| {
        let mut seen: Vec<_> = bodies.iter().map(|body| body.clone().with_id(None)).collect();
        tracker.identify(&mut nobody(time), &mut seen).unwrap();
        // The tracker counts from zero, in the order of the first frame.
        for (seen, body) in seen.iter().zip(&bodies) {
            let number = seen.id().map(|id| id.number() + 1);
            assert_eq!(number, body.id().map(PersonId::number), "{time} s");
        }
        seen
    };
    watch(&mut crossing, 80, identify, |time, controller, people| {
        let [one, other] = [0, 1].map(|who: usize| people[who].led.person());
        nearest = nearest.min((one.floor() - other.floor()).norm());
        let bodies = controller.safety().all_bodies();
        for (who, person) in people.iter().enumerate() {
            let own = |body: &&PersonBody| {
                let place = body.capsule.start();
                let (joint, distance, _) = person.nearest(place);
                let (_, of_other, _) = people[1 - who].nearest(place);
                matches!(joint, Body25::Neck | Body25::MidHip) && distance < of_other
            };
            let walks = person.led.person().velocity().norm() > 1.19;
            for body in bodies.iter().filter(own).filter(|_| time > 0.5 && walks) {
                let Some(velocity) = body.velocity else { continue };
                let error = velocity.mean.y - person.led.person().velocity().y;
                assert!(error.abs() <= velocity.uncertainty, "{time} s: {error} m/s off");
                measured += 1;
            }
        }
    });
    assert!(nearest < 0.35, "they pass at {nearest} m");
    assert!(measured > 300, "{measured} measured velocities");
}

/// Somebody who appears beside a person who vanishes is somebody else.
#[test]
fn vanished_people_are_not_replaced_by_neighbours() {
    let mut tracker = People::new(PeopleSettings::untracked(), TrackerSettings::default()).unwrap();
    let mut people = [0.0, 0.4].map(|y| Bystander::new(1, [3.0, y], None));
    let mut ids = Vec::new();
    for frame in 0..40_u32 {
        let time = 0.05 * f64::from(frame);
        let mut seen = [people[usize::from(frame >= 20)].look(time).with_id(None)];
        tracker.identify(&mut nobody(time), &mut seen).unwrap();
        ids.push(seen[0].id().unwrap());
    }
    assert!(ids[..20].iter().all(|id| *id == ids[0]), "{ids:?}");
    assert!(ids[20..].iter().all(|id| *id == ids[20]) && ids[20] != ids[0], "{ids:?}");
}
