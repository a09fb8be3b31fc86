//! True place of a person, and places at which frames have shown them.

use std::collections::VecDeque;

use nalgebra::Isometry3;
use simulated_people::Joints;

use super::Moment;

/// A person, tick by tick.
#[derive(Clone, Debug, Default)]
pub(crate) struct Witness {
    /// The joints at the last ticks; whether they jumped there.
    history: VecDeque<(Joints, bool)>,
    /// Number of ticks before those.
    forgotten: usize,
    /// Joints as in the newest frame that shows them and has arrived.
    known: Option<Known>,
}

/// Number of ticks that are remembered: no frame arrives later.
const REMEMBERED: usize = 4000;

/// Joints of a person that a frame shows, but for noise.
#[derive(Clone, Copy, Debug)]
struct Known {
    /// When it was taken.
    tick: usize,
    joints: Joints,
    /// A tick before; none where they jumped.
    before: Option<Joints>,
}

impl Witness {
    /// Takes a tick.
    pub(crate) fn push(&mut self, joints: &Joints, jumped: bool) {
        if self.history.len() == REMEMBERED {
            self.history.pop_front();
            self.forgotten += 1;
        }
        self.history.push_back((*joints, jumped));
    }

    /// The newest tick, and the one before; none where they jumped, or before the first tick.
    pub(crate) fn newest(&self) -> Option<(&Joints, Option<&Joints>)> {
        self.at(self.ticks().checked_sub(1)?)
    }

    /// A frame of this tick has arrived that shows them, moved by `error`.
    pub(crate) fn show(&mut self, tick: usize, error: &Isometry3<f64>) {
        let shown = |joints: &Joints| joints.map(|joint| error * joint);
        self.known = self.at(tick).map(|(joints, before)| Known {
            tick,
            joints: shown(joints),
            before: before.map(shown),
        });
    }

    /// Nobody knows of them any more.
    pub(crate) fn forget(&mut self) {
        self.known = None;
    }

    /// Age in ticks of the newest frame that shows them.
    pub(crate) fn unseen_for(&self) -> Option<usize> {
        self.known.map(|known| self.ticks() - known.tick)
    }

    /// The newest tick, for the judge; `contact` says whether all but the head may touch the robot.
    pub(crate) fn moment(&self, contact: bool) -> Option<Moment<'_>> {
        Some(Moment {
            person: self.newest()?,
            known: self.known.as_ref().map(|known| (&known.joints, known.before.as_ref())),
            contact,
        })
    }

    fn ticks(&self) -> usize {
        self.forgotten + self.history.len()
    }

    /// The joints at a tick, or the first that is remembered, and at the one before unless the person jumped.
    fn at(&self, tick: usize) -> Option<(&Joints, Option<&Joints>)> {
        let place = tick.saturating_sub(self.forgotten);
        let (joints, jumped) = self.history.get(place)?;
        let before = place.checked_sub(1).filter(|_| !jumped);
        let before = before.and_then(|place| self.history.get(place));
        Some((joints, before.map(|(joints, _)| joints)))
    }
}
