//! Velocity intervals of a planar base that only moves along its heading.

use ahqp_core::VelocityInterval;

use super::{Joint, JointIntervals};

/// Largest share of the acceleration limit that rotates the base's velocity: |v ω| is at most this share.
const TURNING: f64 = 0.6;
/// Share of the acceleration limit that remains along the heading: 0.6² + 0.8² = 1.
const ALONG: f64 = 0.8;
/// Components of the heading below this are rounding.
const ROUNDING: f64 = 1e-9;

/// The heading of a planar base, and its speeds along it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Heading {
    cosine: f64,
    sine: f64,
    along: VelocityInterval,
}

/// The motion of a base along its heading.
#[derive(Debug, Clone, Copy)]
struct Motion {
    /// Speed along the heading \[m/s\].
    speed: f64,
    /// \[rad/s\]
    turn: f64,
    /// Time in which both can shrink evenly to zero within the accelerations \[s\].
    stop: f64,
    /// Share of both that remains after this period.
    share: f64,
}

/// Acceleration limits of a base: the smaller one of x and y \[m/s²\] and that of yaw \[rad/s²\]; infinite if missing.
#[derive(Debug, Clone, Copy)]
struct Accelerations {
    linear: f64,
    angular: f64,
}

/// The largest |v ω| of a base with this acceleration limit \[m/s²\].
pub(crate) fn turning_acceleration(acceleration: f64) -> f64 {
    TURNING * acceleration
}

impl JointIntervals {
    /// Narrows the intervals of a planar base to velocities along its heading from which it can stop without sliding.
    /// Returns `None` if sliding is inevitable, because the base moves sideways already or its yaw jumped.
    ///
    /// A velocity along the heading rotates with the base, by v ω Δt a period. A limit of the wheels keeps |v ω| ≤ 0.6
    /// a, which leaves 0.8 a along the heading at any yaw. In front of position limits v and ω can shrink evenly to
    /// zero in a time T. The base then moves v T/2 along an arc that turns by ω T/2 in total. The distance towards a
    /// wall is at most (v T/2) (k + ω T/2), where k is the cosine between its normal and the heading.
    ///
    /// `longest` is the time in which the base must be able to stop \[s\].
    pub(crate) fn keep_heading(
        &mut self,
        q: &[f64],
        v: &[f64],
        longest: f64,
        period: f64,
    ) -> Option<Heading> {
        let (&yaw, &[x, y, turn]) = (q.get(2)?, v.first_chunk::<3>()?);
        let (sine, cosine) = yaw.sin_cos();
        let along = speeds([cosine, sine], &self.now)?;
        let mut heading = Heading { cosine, sine, along };
        let accelerations = self.base_accelerations()?;
        let motion = Motion::new(cosine * x + sine * y, turn, accelerations, period);
        let slowed = motion.share * motion.speed.abs();
        let stoppable = ALONG * accelerations.linear * longest;
        let slowest = self.joints.iter().take(2).map(Joint::velocity).fold(stoppable, f64::min);
        let mut most = [slowest; 2];
        let rooms = [0, 1].map(|axis| self.joints[axis].room(q, v[axis], period));
        if rooms.as_flattened().iter().any(|room| room.is_finite()) {
            let (turn, speeds) = arc([cosine, sine], rooms, motion, accelerations, period);
            self.now[2] = within(self.now[2], [turn; 2]);
            most = speeds.map(|speed| speed.min(slowest));
        }
        let own = usize::from(motion.speed > 0.0);
        most[own] = most[own].max(slowed);
        heading.along = within(along, most);
        self.align(&heading);
        Some(heading)
    }

    /// Aligns the intervals of x and y with the heading again, after they were narrowed further.
    pub(crate) fn align_with(&mut self, heading: &Heading) {
        let mut heading = *heading;
        let direction = [heading.cosine, heading.sine];
        let common = speeds(direction, &self.now).filter(|narrow| {
            narrow.lower <= heading.along.upper && narrow.upper >= heading.along.lower
        });
        heading.along = if let Some(narrow) = common {
            VelocityInterval {
                lower: narrow.lower.max(heading.along.lower),
                upper: narrow.upper.min(heading.along.upper),
            }
        } else {
            let middle = |axis: usize| 0.5 * (self.now[axis].lower + self.now[axis].upper);
            let nearest = heading.cosine * middle(0) + heading.sine * middle(1);
            let speed = nearest.max(heading.along.lower).min(heading.along.upper);
            VelocityInterval { lower: speed, upper: speed }
        };
        self.align(&heading);
    }

    /// The time in which a planar base can stop along its heading \[s\].
    pub(crate) fn stop_along(&self, v: &[f64]) -> f64 {
        let (Some([x, y, _]), Some(accelerations)) =
            (v.first_chunk::<3>(), self.base_accelerations())
        else {
            return 0.0;
        };
        x.hypot(*y) / (ALONG * accelerations.linear)
    }

    /// Writes the velocities of a planar base that brakes along its heading at this yaw.
    pub(crate) fn brake_along(&self, yaw: f64, v: &[f64], period: f64, out: &mut [f64]) {
        let (Some(&[x, y, turn]), Some(accelerations)) =
            (v.first_chunk::<3>(), self.base_accelerations())
        else {
            return;
        };
        let (sine, cosine) = yaw.sin_cos();
        let motion = Motion::new(cosine * x + sine * y, turn, accelerations, period);
        let speed = motion.share * motion.speed;
        let slowed = [speed * cosine, speed * sine, motion.share * turn];
        out.iter_mut().zip(slowed).for_each(|(out, slowed)| *out = slowed);
    }

    /// Sets the intervals of x and y to the bounding box of the velocities that the heading allows.
    fn align(&mut self, heading: &Heading) {
        for (interval, part) in self.now.iter_mut().zip([heading.cosine, heading.sine]) {
            let ends = [heading.along.lower, heading.along.upper]
                .map(|speed| if part == 0.0 { 0.0 } else { speed * part });
            *interval =
                VelocityInterval { lower: ends[0].min(ends[1]), upper: ends[0].max(ends[1]) };
        }
    }

    fn base_accelerations(&self) -> Option<Accelerations> {
        let [x, y, yaw] = self.joints.first_chunk::<3>()?;
        let linear = x.acceleration().min(y.acceleration());
        Some(Accelerations { linear, angular: yaw.acceleration() })
    }
}

impl Motion {
    fn new(speed: f64, turn: f64, accelerations: Accelerations, period: f64) -> Self {
        let Accelerations { linear, angular } = accelerations;
        let stop = (speed.abs() / (ALONG * linear)).max(turn.abs() / angular);
        Self { speed, turn, stop, share: 1.0 - period / stop.max(period) }
    }
}

/// The range of speeds along a direction that the intervals of x and y allow.
fn speeds(direction: [f64; 2], intervals: &[VelocityInterval]) -> Option<VelocityInterval> {
    let mut common = VelocityInterval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    for (part, interval) in direction.into_iter().zip(intervals) {
        if part.abs() > ROUNDING {
            let ends = [interval.lower / part, interval.upper / part];
            common.lower = common.lower.max(ends[0].min(ends[1]));
            common.upper = common.upper.min(ends[0].max(ends[1]));
        }
    }
    (common.lower <= common.upper).then_some(common)
}

/// The interval cut to −most\[0\] and most\[1\]; its nearest end if nothing remains.
fn within(interval: VelocityInterval, most: [f64; 2]) -> VelocityInterval {
    let into = |velocity: f64| velocity.max(interval.lower).min(interval.upper);
    VelocityInterval { lower: into(-most[0]), upper: into(most[1]) }
}

/// The largest turn rate and the largest speeds backwards and forwards from which the base can stop on an arc. The arc
/// stays within the base's position limits.
fn arc(
    direction: [f64; 2],
    rooms: [[f64; 2]; 2],
    motion: Motion,
    accelerations: Accelerations,
    period: f64,
) -> (f64, [f64; 2]) {
    // Each wall has the component of the heading towards it and the distance to it.
    let walls = |sign: f64| {
        direction.into_iter().zip(rooms).flat_map(move |(part, [down, up])| {
            [(-sign * part, down.max(0.0)), (sign * part, up.max(0.0))]
        })
    };
    let own = if motion.speed < 0.0 { -1.0 } else { 1.0 };
    let (slowed, turning) = (motion.share * motion.speed.abs(), motion.share * motion.turn.abs());
    let mut time = motion.stop + period;
    for (part, room) in walls(own) {
        // slowed T/2 (part + turning T/2) = room.
        let (square, linear) = (0.25 * slowed * turning, 0.5 * slowed * part);
        let root = (linear * linear + 4.0 * square * room).sqrt();
        if linear + root > 0.0 {
            time = time.min(2.0 * room / (linear + root));
        }
    }
    let time = time.max(motion.stop - period).max(period);
    let mut turn =
        (accelerations.angular * time).min(motion.turn.abs() + accelerations.angular * period);
    for (part, room) in walls(own).filter(|_| slowed > 0.0) {
        turn = turn.min((2.0 * room / (slowed * time) - part) * 2.0 / time);
    }
    let turn = turn.max(turning);
    let fastest = |sign: f64| {
        walls(sign).fold(ALONG * accelerations.linear * time, |fastest: f64, (part, room)| {
            let towards = part + 0.5 * turn * time;
            if towards > 0.0 { fastest.min(2.0 * room / (time * towards)) } else { fastest }
        })
    };
    (turn, [fastest(-1.0), fastest(1.0)])
}
