//! Judge of the robot's distance from the true person.
//!
//! A pair is a capsule of the robot and one of the person. It is **in breach** in a tick if the robot moves towards the
//! person, v_r > 0, within the protective distance
//!
//! S_p = v_h (T_r + T_s) + v_r T_r + S_s + C + Z_r.
//!
//! The stopping distance is S_s = v_b²/(2a_b) + v_a²/(2a_a). The stopping time T_s is the longer of v_b/a_b and
//! v_a/a_a. Here v_b and v_a are the shares of base and arm in the approach speed v_r. The speed v_r is that at which
//! the command moves the robot's capsule towards the person's capsule, held still. The speed v_h is that of the
//! person's capsule towards the robot's, held still. The uncertainty Z_d of the person's place is zero, since the judge
//! knows the place.
//!
//! A breach is **the person's own** in two cases only:
//! - There is no breach against the body as it was and moved in the newest camera frame that had reached the robot. The
//!   person has then moved since.
//! - The robot approaches no more than in an emergency stop, in which every joint brakes at its limits of acceleration
//!   and jerk. The breach then began before the robot could know of it.
//!
//! Every other breach is a **violation**. A person who works with the robot may touch it, except with the head. These
//! pairs count separately as contacts, for which the force matters.

use moca_model::whole_body::robot::JointLimits;

use super::body::{self, PART_COUNT};
use super::rod::{Ball, Rod};

/// Speed towards a person above which the robot approaches \[m/s\]; smaller values are rounding.
const TOWARDS: f64 = 1e-6;
/// Step of the derivatives of distances \[s\].
const STEP: f64 = 1e-6;
/// Tolerance of a distance for rounding \[m\].
const ROUNDING: f64 = 1e-6;
/// Distance below which a part that may be touched counts as about to be touched \[m\].
const TOUCHING: f64 = 0.05;

/// The terms of the protective distance.
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    /// Reaction time T_r \[s\].
    pub reaction_time: f64,
    /// Deceleration a_a of the arm \[m/s²\].
    pub deceleration: f64,
    /// Number of the base's joints, which are the first.
    pub base_joints: usize,
    /// Deceleration a_b of the base \[m/s²\].
    pub base_deceleration: f64,
    /// Intrusion distance C \[m\].
    pub intrusion: f64,
    /// Uncertainty Z_r of the robot's place \[m\].
    pub robot_uncertainty: f64,
}

/// The robot's capsules a moment before and after, at some velocity.
#[derive(Clone, Debug, Default)]
pub(super) struct Motion {
    pub(super) before: Vec<Rod>,
    pub(super) after: Vec<Rod>,
}

/// The robot's capsules now, and their motions as commanded and in an emergency stop.
#[derive(Clone, Debug, Default)]
pub(super) struct Robot {
    pub(super) now: Vec<Rod>,
    pub(super) commanded: Motion,
    /// The commanded motion of the base alone.
    pub(super) base: Motion,
    pub(super) stopping: Motion,
}

impl Motion {
    /// The speed at which a capsule approaches one that is held still \[m/s\].
    fn towards(&self, link: usize, person: &Rod) -> f64 {
        (self.before[link].distance(person) - self.after[link].distance(person)) / (2.0 * STEP)
    }

    /// The largest speed of a capsule's points \[m/s\].
    fn fastest(&self, link: usize) -> f64 {
        self.before[link].farthest_move(&self.after[link]) / (2.0 * STEP)
    }
}

/// Half the time from `before` to `after` (s).
pub(super) const MOMENT: f64 = STEP;

/// The person's capsules now and a period before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub(super) now: [Rod; PART_COUNT],
    /// `None` after a jump, which has no speed.
    pub(super) before: Option<[Rod; PART_COUNT]>,
}

impl Body {
    /// Balls around the parts, and their largest speeds \[m/s\].
    fn bounds(&self, period: f64) -> [(Ball, f64); PART_COUNT] {
        std::array::from_fn(|part| {
            let now = &self.now[part];
            let moved = self.before.map_or(0.0, |before| before[part].farthest_move(now));
            (now.ball(), moved / period)
        })
    }

    /// The distance of a part from a capsule of the robot \[m\], and the speed at which the part approaches it \[m/s\].
    fn closing(&self, link: &Rod, part: usize, period: f64) -> (f64, f64) {
        let gap = link.distance(&self.now[part]);
        let before = self.before.map(|before| link.distance(&before[part]));
        (gap, before.map_or(0.0, |before| (before - gap) / period))
    }
}

/// The judgement of a tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Verdict {
    /// The pair of capsules that the robot is to blame for.
    pub violation: Option<Blame>,
    /// True if there is a breach that is the person's own.
    pub person_caused: bool,
    /// True if the robot approaches a part that it may touch.
    pub contact: bool,
    /// Largest contact speed of parts within 5 cm \[m/s\]; `None` if there is none. It is the robot's speed towards the
    /// part minus the speed at which the part moves away.
    pub contact_speed: Option<f64>,
}

impl Verdict {
    /// Adds the judgement of another person.
    pub(super) fn add(&mut self, other: &Self) {
        self.violation = self.violation.or(other.violation);
        self.person_caused |= other.person_caused;
        self.contact |= other.contact;
        self.contact_speed =
            [self.contact_speed, other.contact_speed].into_iter().flatten().reduce(f64::max);
    }
}

/// A violation that the robot is to blame for.
#[derive(Clone, Copy, Debug)]
#[expect(dead_code, reason = "read by people, in its debug form")]
pub struct Blame {
    link: usize,
    part: usize,
    /// Speed of the robot towards the person \[m/s\].
    speed: f64,
    /// Distance and speed of the person towards the robot \[m, m/s\].
    now: (f64, f64),
    /// Distance and approach speed of the person as the robot could know them.
    known: Option<(f64, f64)>,
}

/// T_r + T_s.
fn time_to_stop(terms: &Terms, [base, arm]: [f64; 2]) -> f64 {
    terms.reaction_time + (base / terms.base_deceleration).max(arm / terms.deceleration)
}

/// The protective distance S_p of the formula above.
fn protective_distance(terms: &Terms, person: f64, [base, arm]: [f64; 2]) -> f64 {
    let stopping = 0.5 * (base * base / terms.base_deceleration + arm * arm / terms.deceleration);
    person * time_to_stop(terms, [base, arm])
        + (base + arm) * terms.reaction_time
        + stopping
        + terms.intrusion
        + terms.robot_uncertainty
}

/// Returns true if a pair is in breach, for a body and a period \[s\].
fn in_breach(
    terms: &Terms,
    robot: &Robot,
    body: &Body,
    (link, part): (usize, usize),
    period: f64,
) -> bool {
    let person = &body.now[part];
    let towards = robot.commanded.towards(link, person);
    if towards <= TOWARDS {
        return false;
    }
    let base = robot.base.towards(link, person).clamp(0.0, towards);
    let (distance, coming) = body.closing(&robot.now[link], part, period);
    distance < protective_distance(terms, coming.max(0.0), [base, towards - base])
}

/// Judges a tick for the present body and the one of the newest frame that had arrived. `contact` says that all parts
/// except the head may touch the robot.
pub(super) fn judge(
    terms: &Terms,
    robot: &Robot,
    now: &Body,
    known: Option<&Body>,
    contact: bool,
    period: f64,
) -> Verdict {
    let mut verdict = Verdict::default();
    let parts = now.bounds(period);
    for link in 0..robot.now.len() {
        // Most pairs are too far apart even at the largest speeds of both.
        let ball = robot.now[link].ball();
        let fastest = [robot.base.fastest(link), robot.commanded.fastest(link)];
        let standing = protective_distance(terms, 0.0, fastest) + ROUNDING;
        let time = time_to_stop(terms, fastest);
        for (part, (around, swiftest)) in parts.iter().enumerate() {
            let pair = (link, part);
            if ball.is_beyond(around, standing + swiftest * time) {
                continue;
            }
            if contact && body::may_touch(part) {
                let (gap, coming) = now.closing(&robot.now[link], part, period);
                if gap <= TOUCHING {
                    let speed = robot.commanded.towards(link, &now.now[part]) + coming.min(0.0);
                    let fastest = verdict.contact_speed.unwrap_or(0.0).max(speed);
                    verdict.contact_speed = Some(fastest);
                }
            }
            if !in_breach(terms, robot, now, pair, period) {
                continue;
            }
            let towards = robot.commanded.towards(link, &now.now[part]);
            if contact && body::may_touch(part) {
                verdict.contact = true;
            } else if !known.is_some_and(|known| in_breach(terms, robot, known, pair, period))
                || stops(robot, now, pair)
            {
                verdict.person_caused = true;
            } else {
                let closing = |body: &Body| body.closing(&robot.now[link], part, period);
                let (now, known) = (closing(now), known.map(closing));
                verdict.violation = Some(Blame { link, part, speed: towards, now, known });
            }
        }
    }
    verdict
}

/// Returns true if a pair approaches no more than in an emergency stop.
fn stops(robot: &Robot, body: &Body, (link, part): (usize, usize)) -> bool {
    let person = &body.now[part];
    let least = robot.stopping.towards(link, person);
    robot.commanded.towards(link, person) <= least.max(0.0) + TOWARDS
}

/// Writes the velocities one period into an emergency stop. Every joint brakes at its acceleration limit, which it
/// reaches and leaves at its jerk limit.
///
/// The last part of a stop, from the limit a to rest, satisfies α² = 2 j v; the solution of α Δt + α²/(2j) = v leads to
/// it.
pub(super) fn emergency_stop(
    limits: &[JointLimits],
    acceleration: &[f64],
    velocity: &mut [f64],
    period: f64,
) {
    for ((limits, acceleration), velocity) in limits.iter().zip(acceleration).zip(velocity) {
        let speed = velocity.abs();
        let root = (period * period + 2.0 * speed / limits.jerk).sqrt();
        let onset = -(2.0 * speed / (period + root)).min(limits.acceleration).copysign(*velocity);
        let change = limits.jerk * period;
        let next = acceleration + (onset - acceleration).clamp(-change, change);
        *velocity += next * period;
    }
}
