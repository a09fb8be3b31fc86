//! Somebody around the robot, who keeps to the speeds that a soak means something with.

use nalgebra::{Isometry3, Point3};
use simulated_people::{CapturedMotion, Wanderer};

use crate::error::Error;
use crate::judges::{Moment, Witness, body};

/// Largest speed of arms \[m/s\].
const FASTEST_ARM: f64 = 8.0;

/// Time between samples of a motion \[s\], and the share of a limit to which it is slowed, since it may be faster
/// between them.
const SAMPLE: f64 = 5e-3;
const WITHIN: f64 = 0.95;

/// Largest speed of a part, whose body keeps to `largest` \[m/s\].
fn limit(part: usize, largest: f64) -> f64 {
    if body::is_arm(part) { FASTEST_ARM } else { largest }
}

/// The largest share of its speed at which a motion keeps to the limits. The way back has the same speeds.
fn pace(motion: &CapturedMotion, largest: f64) -> f64 {
    let (mut pace, mut time) = (1.0_f64, 0.0);
    let mut before = body::capsules(&motion.joints(0.0));
    while time < 0.5 * motion.cycle() {
        time += SAMPLE;
        let now = body::capsules(&motion.joints(time));
        for (part, (from, to)) in before.iter().zip(&now).enumerate() {
            let speed = from.farthest_move(to) / SAMPLE;
            pace = pace.min(WITHIN * limit(part, largest) / speed);
        }
        before = now;
    }
    pace
}

/// A person, from the beginning of the episode on.
#[derive(Clone, Debug)]
pub(super) struct Witnessed {
    pub(super) person: Wanderer,
    witness: Witness,
}

impl Witnessed {
    pub(super) fn new(person: Wanderer) -> Self {
        Self { person, witness: Witness::default() }
    }

    /// The same person, with the motion of a real one, slow enough for [`advance`](Self::advance) with this speed
    /// \[m/s\].
    pub(super) fn performing(self, motion: CapturedMotion, largest: f64) -> Self {
        let pace = pace(&motion, largest);
        let person = self.person.performing(motion.at_pace(pace));
        Self { person, ..self }
    }

    /// Goes on by a period, to `time` \[s\]; the robot holds something to work on at `object` \[m\].
    ///
    /// # Errors
    /// Bodies keep to the speed that the robot assumes where it measures none, `largest` \[m/s\], and arms to
    /// [`FASTEST_ARM`]; who does not would make the soak mean nothing.
    pub(super) fn advance(
        &mut self,
        (time, period): (f64, f64),
        object: &Point3<f64>,
        largest: f64,
    ) -> Result<(), Error> {
        self.person.advance(time, period, object);
        self.witness.push(&self.person.person().joints(), self.person.jumped());
        let Some((now, Some(before))) = self.witness.newest() else { return Ok(()) };
        let (from, to) = (body::capsules(before), body::capsules(now));
        for (part, (from, to)) in from.iter().zip(&to).enumerate() {
            let limit = limit(part, largest);
            let speed = from.farthest_move(to) / period;
            if speed > limit {
                return Err(Error::TooFast { part, speed, limit });
            }
        }
        Ok(())
    }

    /// A frame of this tick has arrived that shows them, moved by `error`.
    pub(super) fn show(&mut self, tick: usize, error: &Isometry3<f64>) {
        self.witness.show(tick, error);
    }

    /// Nobody knows of them any more.
    pub(super) fn forget(&mut self) {
        self.witness.forget();
    }

    /// Age in ticks of the newest frame that shows them.
    pub(super) fn unseen_for(&self) -> Option<usize> {
        self.witness.unseen_for()
    }

    /// Record of this tick for the judge; `contact` says whether all but the head may touch the robot.
    pub(super) fn moment(&self, contact: bool) -> Option<Moment<'_>> {
        self.witness.moment(contact)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use simulated_people::generator;

    use super::*;

    #[test]
    fn real_people_keep_to_the_speeds() {
        let (largest, period) = (1.6, 1e-3);
        for (stream, name) in (0..).zip(CapturedMotion::NAMES) {
            let motion = CapturedMotion::named(name).unwrap();
            let slowed = motion.clone().at_pace(pace(&motion, largest));
            let draw = generator(1, stream);
            let wanderer = Wanderer::passing_by(draw, Vector2::zeros());
            let mut person = Witnessed::new(wanderer).performing(motion, largest);
            let mut before = body::capsules(&person.person.person().joints());
            let (mut time, mut share) = (0.0, 0.0_f64);
            // The way back has the same speeds.
            while time < 0.5 * slowed.cycle() {
                person.advance((time, period), &Point3::origin(), largest).unwrap();
                let now = body::capsules(&person.person.person().joints());
                for (part, (from, to)) in before.iter().zip(&now).enumerate() {
                    share = share.max(from.farthest_move(to) / period / limit(part, largest));
                }
                before = now;
                time += period;
            }
            let own = 0.99 * slowed.cycle() <= std::f64::consts::PI * slowed.duration();
            assert!(own || (0.9..=1.0).contains(&share), "{name}: {share} of a limit");
        }
    }
}
