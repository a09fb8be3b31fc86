//! Somebody around the robot: where they truly are, and where frames have shown them.

use nalgebra::{Isometry3, Point3};

use crate::Error;
use crate::judges::{Moment, body};
use crate::people::{Joints, Wanderer};

/// How fast arms are at most \[m/s\].
const FASTEST_ARM: f64 = 8.0;

/// A person, from the beginning of the episode on.
#[derive(Clone, Debug)]
pub(super) struct Witnessed {
    pub(super) person: Wanderer,
    /// The joints at every tick; whether they jumped there.
    history: Vec<(Joints, bool)>,
    /// As in the newest frame that shows them and has arrived.
    known: Option<Known>,
}

/// What a frame shows of a person, but for noise.
#[derive(Clone, Copy, Debug)]
struct Known {
    /// When it was taken.
    tick: usize,
    joints: Joints,
    /// A tick before; none where they jumped.
    before: Option<Joints>,
}

impl Witnessed {
    pub(super) fn new(person: Wanderer) -> Self {
        Self { person, history: Vec::new(), known: None }
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
        self.history.push((self.person.person().joints(), self.person.jumped()));
        let (now, before) = self.at(self.history.len() - 1);
        let Some(before) = before else { return Ok(()) };
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
        let (joints, before) = self.at(tick);
        let shown = |joints: &Joints| joints.map(|joint| error * joint);
        self.known = Some(Known { tick, joints: shown(joints), before: before.map(shown) });
    }

    /// Nobody knows of them any more.
    pub(super) fn forget(&mut self) {
        self.known = None;
    }

    /// How many ticks ago the newest frame was taken that shows them.
    pub(super) fn unseen_for(&self) -> Option<usize> {
        self.known.map(|known| self.history.len() - known.tick)
    }

    /// This tick, for the judge; `contact` says whether all but the head may touch the robot.
    pub(super) fn moment(&self, contact: bool) -> Moment<'_> {
        Moment {
            person: self.at(self.history.len() - 1),
            known: self.known.as_ref().map(|known| (&known.joints, known.before.as_ref())),
            contact,
        }
    }

    /// The joints at a tick and at the one before, unless the person jumped between them.
    fn at(&self, tick: usize) -> (&Joints, Option<&Joints>) {
        let (joints, jumped) = &self.history[tick];
        let before = tick.checked_sub(1).filter(|_| !jumped).map(|tick| &self.history[tick].0);
        (joints, before)
    }
}
