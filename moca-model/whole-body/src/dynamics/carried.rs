//! Mass and first moment of the subtree of each body.

use crate::state::posed::Posed;

impl Posed<'_> {
    /// Sums up m and Σ m (c − p) of the subtree of each body at p, from the tips to the root.
    pub(super) fn sum_up_carried(&mut self) {
        let data = &mut *self.data;
        let carried = &mut data.scratch.carried;
        for ((carried, inertia), pose) in carried.iter_mut().zip(&data.inertias).zip(&data.poses) {
            carried.mass = inertia.mass;
            carried.moment = pose.rotation * (inertia.mass * inertia.centre);
        }
        for (index, mover) in self.model.movers.iter().enumerate().rev() {
            let apart = data.poses[index + 1].position - data.poses[mover.parent].position;
            let own = carried[index + 1];
            let parent = &mut carried[mover.parent];
            parent.mass += own.mass;
            parent.moment += own.moment + own.mass * apart;
        }
    }
}
