//! Somebody around the robot, who keeps to the speeds that a soak means something with.

use nalgebra::{Isometry3, Point3};

use crate::Error;
use crate::judges::{Moment, Witness, body};
use crate::people::Wanderer;

/// Largest speed of arms \[m/s\].
const FASTEST_ARM: f64 = 8.0;

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
            let largest = if body::is_arm(part) { FASTEST_ARM } else { largest };
            let speeds =
                from.ends.iter().zip(&to.ends).map(|(from, to)| (to - from).norm() / period);
            let speed = speeds.fold(0.0, f64::max);
            if speed > largest {
                return Err(Error::TooFast { part, speed, limit: largest });
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
