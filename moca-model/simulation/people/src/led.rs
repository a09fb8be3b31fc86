//! A person who is led: goes, stands and works as somebody outside says.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point2, Point3, Rotation2, Vector2, Vector3};
use rand_chacha::ChaCha8Rng;

use super::activity::Activity;
use super::motion::{Gait, Goal};
use super::movement::Movement;
use super::person::Person;
use crate::error::{Error, in_range};

/// Slower than this they stand, and may begin a movement on the spot (m/s).
const STANDING: f64 = 0.05;
/// Distance of the goal ahead of a person who walks in a direction (m).
const AHEAD: f64 = 1.0;
/// Nearer than this no direction to face is told (m).
const TOO_NEAR: f64 = 0.1;

/// Goal of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// Stops, and stays there.
    Stand,
    /// Walk to a place on the floor, in the world (m).
    To(Point2<f64>),
    /// Walk in a direction, in the world, until told otherwise; its length does not count.
    Along(Vector2<f64>),
}

/// Direction to face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facing {
    /// Towards what the robot holds.
    Robot,
    /// Direction of the way.
    Way,
    /// Yaw in the world (rad).
    Heading(f64),
    /// Turns on to the left at this rate, up to that of the gait (rad/s).
    Turning(f64),
}

/// Task of the right hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Choice of the activity: a person who uses a tool has it at the object.
    Work,
    /// Straight ahead at the height of the shoulder.
    Ahead,
    /// Between the object and the robot's hand.
    Between,
}

/// Orders to a led person.
///
/// ```
/// use simulated_people::{Lead, LedPerson};
///
/// let lead = Lead { speed: 3.0, ..Lead::default() };
/// assert_eq!(lead.validate().unwrap_err().to_string(), "speed = 3: give 0.1 to 1.2 m/s");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lead {
    /// Destination. Default [`Way::Stand`].
    pub way: Way,
    /// Walking speed (m/s), 0.1 to 1.2. Default 0.5.
    pub speed: f64,
    /// Direction to face. Default [`Facing::Robot`].
    pub facing: Facing,
    /// Activity of the person. Default [`Activity::Walk`].
    pub activity: Activity,
    /// Forward lean (rad), 0 to 1.2. Default 0.
    pub lean: f64,
    /// Lowering of the pelvis, in statures, 0 to 0.2. Default 0.
    pub squat: f64,
    /// Task of the right hand. Default [`Reach::Work`].
    pub reach: Reach,
}

impl Default for Lead {
    fn default() -> Self {
        Self {
            way: Way::Stand,
            speed: 0.5,
            facing: Facing::Robot,
            activity: Activity::Walk,
            lean: 0.0,
            squat: 0.0,
            reach: Reach::Work,
        }
    }
}

impl Lead {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Value`] names the field that is wrong.
    pub fn validate(&self) -> Result<(), Error> {
        in_range("speed", self.speed, 0.1..=1.2, "0.1 to 1.2 m/s")?;
        in_range("lean", self.lean, 0.0..=1.2, "0 to 1.2 rad")?;
        in_range("squat", self.squat, 0.0..=0.2, "0 to 0.2 statures")?;
        let room = || -FARTHEST..=FARTHEST;
        match self.way {
            Way::Stand => {}
            Way::To(place) => {
                in_range("way.to.x", place.x, room(), "a place within 20 m")?;
                in_range("way.to.y", place.y, room(), "a place within 20 m")?;
            }
            Way::Along(direction) => {
                let length = direction.norm();
                in_range("way.along", length, 1e-3..=1e3, "a direction")?;
            }
        }
        match self.facing {
            Facing::Robot | Facing::Way => Ok(()),
            Facing::Heading(yaw) => {
                in_range("facing.heading", yaw, -TAU..=TAU, "a yaw of -2π to 2π")
            }
            Facing::Turning(rate) => {
                in_range("facing.turning", rate, -2.0..=2.0, "a rate of -2 to 2 rad/s")
            }
        }
    }
}

/// People are led no farther than this from the origin (m).
const FARTHEST: f64 = 20.0;

/// Facts about the robot that a led person has to know, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workplace {
    /// Place of the hand of somebody who works (m).
    pub object: Point3<f64>,
    /// Place between the object and the robot's hand (m).
    pub between: Point3<f64>,
}

/// Somebody who does as [`Lead`] says, within what people can do.
///
/// ```
/// use simulated_people::{Lead, LedPerson, Way, Workplace};
/// use nalgebra::{Point2, Point3};
///
/// let mut person = LedPerson::new(1.75, Point2::new(3.0, 0.0), 0.0)?;
/// person.lead(Lead { way: Way::To(Point2::new(2.0, 0.0)), ..Lead::default() })?;
/// let object = Point3::new(1.0, 0.0, 1.0);
/// let workplace = Workplace { object, between: object };
/// (0..5000).for_each(|_| person.advance(1e-3, &workplace));
/// assert!((person.person().floor() - Point2::new(2.0, 0.0)).norm() < 0.05);
/// # Ok::<(), simulated_people::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct LedPerson {
    person: Person,
    lead: Lead,
    /// Place where they stand or will have stopped (m, world).
    stop: Point2<f64>,
    heading: f64,
    /// Movement that they begin once they stand.
    movement: Option<(Movement, ChaCha8Rng)>,
}

impl LedPerson {
    /// Somebody who stands there, in the world (m, rad).
    ///
    /// # Errors
    /// [`Error::Value`] for a stature (m) that nobody has.
    pub fn new(stature: f64, floor: Point2<f64>, heading: f64) -> Result<Self, Error> {
        in_range("stature", stature, 1.0..=2.3, "1 to 2.3 m")?;
        let lead = Lead::default();
        // Hands no slower than hands are that work.
        let gait = Gait { hand_speed: 0.5, turning_rate: 1.0, ..Gait::CAREFUL };
        let person = Person::standing(stature, floor, heading, gait, lead.activity);
        Ok(Self { person, lead, stop: floor, heading, movement: None })
    }

    /// Does this from now on.
    ///
    /// # Errors
    /// Those of [`Lead::validate`]; they then go on as before.
    pub fn lead(&mut self, lead: Lead) -> Result<(), Error> {
        lead.validate()?;
        if lead.way == Way::Stand && self.lead.way != Way::Stand {
            let velocity = self.person.velocity();
            let braking = velocity.norm() / (2.0 * Gait::CAREFUL.acceleration);
            self.stop = self.person.floor() + velocity * braking;
        }
        self.lead = lead;
        Ok(())
    }

    /// The orders that they follow.
    pub fn told(&self) -> &Lead {
        &self.lead
    }

    /// Begins a movement on the spot as soon as they stand.
    pub fn begin(&mut self, movement: Movement, draw: ChaCha8Rng) {
        self.movement = Some((movement, draw));
    }

    /// Moves on by `dt` (s).
    pub fn advance(&mut self, dt: f64, workplace: &Workplace) {
        let (floor, lead) = (self.person.floor(), self.lead);
        let stands = self.person.velocity().norm() < STANDING;
        if let Some((movement, mut draw)) = self.movement.take_if(|_| stands) {
            self.person.begin(movement, &mut draw);
        }
        let way = match lead.way {
            // Somebody who is busy on the spot stays there.
            _ if self.person.is_busy() => Way::Stand,
            way => way,
        };
        let (goal, stop) = match way {
            Way::Stand => (self.stop, true),
            Way::To(place) => (place, true),
            Way::Along(direction) => (floor + direction.normalize() * AHEAD, false),
        };
        if way != Way::Stand {
            self.stop = floor;
        }
        self.heading = self.towards(lead.facing, goal, workplace);
        let goal = Goal { floor: goal, heading: self.heading, speed: lead.speed, stop };
        self.person.bend(lead.lean, lead.squat);
        let point = self.hand(lead, workplace);
        self.person.reach_towards(point.as_ref());
        self.person.advance(&goal, lead.activity, dt);
    }

    /// The yaw to turn to, by the shorter way (rad).
    fn towards(&self, facing: Facing, goal: Point2<f64>, workplace: &Workplace) -> f64 {
        let (floor, heading) = (self.person.floor(), self.person.heading());
        let to = |point: Point2<f64>| {
            let way = point - floor;
            if way.norm() > TOO_NEAR { way.y.atan2(way.x) } else { self.heading }
        };
        let yaw = match facing {
            Facing::Robot => to(workplace.object.xy()),
            Facing::Way => to(goal),
            Facing::Heading(yaw) => yaw,
            // The gait turns at three times the angle that is left.
            Facing::Turning(rate) => heading + rate / 3.0,
        };
        heading + (yaw - heading + PI).rem_euclid(TAU) - PI
    }

    /// Place of the right hand; none if the activity moves it.
    fn hand(&self, lead: Lead, workplace: &Workplace) -> Option<Point3<f64>> {
        match (lead.reach, lead.activity) {
            (Reach::Ahead, _) => {
                let ahead = Rotation2::new(self.person.heading()) * Vector2::x() * AHEAD;
                let shoulder = Point3::from(self.person.right_shoulder());
                Some(shoulder + Vector3::new(ahead.x, ahead.y, 0.0))
            }
            (Reach::Between, _) => Some(workplace.between),
            (Reach::Work, Activity::Use(_)) => Some(workplace.object),
            (Reach::Work, _) => None,
        }
    }

    /// Something stands in the way, in the direction against `away`: they are moved so far from it (m).
    pub fn slide(&mut self, away: Vector2<f64>, distance: f64) {
        self.person.slide(away, distance);
    }

    /// Something stands in the way: they stop where they are.
    pub fn bump(&mut self) {
        self.person.halt();
        self.stop = self.person.floor();
    }

    /// The person.
    pub fn person(&self) -> &Person {
        &self.person
    }
}

#[cfg(test)]
mod tests {
    use vision_models::{Body25, Tool};

    use super::*;

    const WORKPLACE: Workplace =
        Workplace { object: Point3::new(1.0, 0.0, 1.0), between: Point3::new(0.9, 0.0, 1.0) };

    fn led(lead: Lead, seconds: f64) -> (LedPerson, f64) {
        let mut person = LedPerson::new(1.75, Point2::new(3.0, 0.0), PI).unwrap();
        person.lead(lead).unwrap();
        let (mut time, mut fastest) = (0.0, 0.0_f64);
        while time < seconds {
            person.advance(1e-3, &WORKPLACE);
            fastest = fastest.max(person.person().velocity().norm());
            time += 1e-3;
        }
        (person, fastest)
    }

    #[test]
    fn walks_where_told_at_the_speed_told() {
        for speed in [0.2, 0.5, 1.0] {
            let way = Way::To(Point2::new(3.0, -2.0));
            let (person, fastest) = led(Lead { way, speed, ..Lead::default() }, 15.0);
            let left = person.person().floor() - Point2::new(3.0, -2.0);
            assert!(left.norm() < 0.03, "{speed}: {left}");
            assert!((fastest - speed).abs() < 1e-3, "{fastest} of {speed} m/s");
        }
        let way = Way::Along(Vector2::new(0.0, 5.0));
        let (mut person, _) = led(Lead { way, speed: 0.6, ..Lead::default() }, 4.0);
        assert!((person.person().velocity() - Vector2::new(0.0, 0.6)).norm() < 1e-6);
        person.lead(Lead::default()).unwrap();
        let stops = person.person().floor().y;
        (0..3000).for_each(|_| person.advance(1e-3, &WORKPLACE));
        let walked_on = person.person().floor().y - stops;
        assert!((0.0..0.5).contains(&walked_on) && person.person().velocity().norm() < 1e-2);
    }

    #[test]
    fn faces_what_it_is_told_to_face() {
        let way = Way::To(Point2::new(1.0, 2.0));
        let (person, _) = led(Lead { way, ..Lead::default() }, 12.0);
        let heading = person.person().heading().rem_euclid(TAU);
        assert!((heading - 1.5 * PI).abs() < 0.05, "towards the robot: {heading}");
        let facing = Facing::Heading(0.5);
        let (person, _) = led(Lead { facing, ..Lead::default() }, 8.0);
        assert!((person.person().heading().rem_euclid(TAU) - 0.5).abs() < 0.01);
    }

    #[test]
    fn bends_and_keeps_the_hand_at_work() {
        let (floor, use_drill) = (Point2::new(1.4, 0.1), Activity::Use(Tool::Drill));
        let way = Way::To(floor);
        let upright = Lead { way, activity: use_drill, ..Lead::default() };
        let bent = Lead { lean: 0.6, squat: 0.1, ..upright };
        let [(upright, _), (bent, _)] = [upright, bent].map(|lead| led(lead, 12.0));
        let at = |person: &LedPerson, joint: Body25| person.person().joints()[joint.index()];
        let neck = at(&upright, Body25::Neck) - at(&bent, Body25::Neck);
        assert!(neck.z > 0.2, "{neck}");
        let [upright, bent] = [&upright, &bent].map(|person| {
            let (elbow, wrist) = (at(person, Body25::RightElbow), at(person, Body25::RightWrist));
            super::super::Arm::of_stature(1.75).grip(&elbow.coords, &wrist.coords)
        });
        let object = WORKPLACE.object.coords;
        assert!((upright - object).norm() < 0.02 && (bent - object).norm() < 0.02);
    }

    #[test]
    fn head_speeds_up_as_in_a_bow() {
        let mut person = LedPerson::new(1.75, Point2::new(1.4, 0.1), 0.0).unwrap();
        let (mut nose, mut velocity) = (None, None::<Vector3<f64>>);
        for tick in 0..3000 {
            if tick % 150 == 0 {
                let lean = [0.0, 1.2, 0.5][tick / 150 % 3];
                person.lead(Lead { lean, ..Lead::default() }).unwrap();
            }
            person.advance(1e-3, &WORKPLACE);
            let now = person.person().joints()[Body25::Nose.index()];
            let moves = nose.replace(now).map(|before: Point3<f64>| (now - before) / 1e-3);
            if let (Some(before), Some(moves)) = (velocity, moves) {
                // The head is 0.8 m above the hips.
                assert!((moves - before).norm() < 7.0 * 1e-3, "{tick}");
            }
            velocity = moves;
        }
    }

    #[test]
    fn what_nobody_can_do_is_refused() {
        let mut person = LedPerson::new(1.75, Point2::origin(), 0.0).unwrap();
        let place = Point2::new(f64::NAN, 0.0);
        for lead in [
            Lead { speed: f64::NAN, ..Lead::default() },
            Lead { lean: 2.0, ..Lead::default() },
            Lead { way: Way::To(place), ..Lead::default() },
            Lead { way: Way::Along(Vector2::zeros()), ..Lead::default() },
            Lead { facing: Facing::Turning(9.0), ..Lead::default() },
        ] {
            assert!(person.lead(lead).is_err(), "{lead:?}");
            assert_eq!(*person.told(), Lead::default());
        }
        assert!(LedPerson::new(0.2, Point2::origin(), 0.0).is_err());
    }
}
