//! Stacks with and without each of the changes in progress, and their weights.

use super::Place;
use super::change::{Change, Difference};
use super::data::Data;
use super::plan::{Entry, Plan};
use crate::error::Error;
use crate::linalg::list::List;
use crate::problem::ids::LevelId;
use crate::solver::settings::Settings;

#[derive(Debug, Clone)]
pub(super) struct Blend {
    pub(super) changes: List<Change>,
    /// One plan for each set of completed changes. Bit i of the index is change i.
    pub(super) plans: Vec<Plan>,
    settings: Settings,
}

impl Blend {
    /// Largest number of changes at a time.
    pub(super) const MAX_CHANGES: usize = 4;

    pub(super) fn new(data: &Data, settings: Settings) -> Result<Self, Error> {
        let order = data.ids.iter().map(|&id| Entry { id, active: true }).collect();
        Ok(Self {
            changes: List::with_capacity(Self::MAX_CHANGES),
            plans: vec![Plan::new(order, data, settings)?],
            settings,
        })
    }

    pub(super) fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        self.settings = settings;
        self.plans.iter_mut().try_for_each(|plan| plan.set_settings(settings))
    }

    /// Sets the weight of each set of changes to the length of the range of thresholds at which
    /// exactly these are made. In the order of their shares, the changes are made one after the
    /// other.
    pub(super) fn set_weights(&mut self) {
        self.plans.iter_mut().for_each(|plan| plan.weight = 0.0);
        let mut made = 0;
        let mut threshold = 1.0;
        loop {
            let left = self.changes.iter().enumerate().filter(|(i, _)| made & (1 << i) == 0);
            let next = left
                .map(|(i, change)| (i, change.share.value()))
                .max_by(|(_, a), (_, b)| a.total_cmp(b));
            let share = next.map_or(0.0, |(_, share)| share);
            if let Some(plan) = self.plans.get_mut(made) {
                plan.weight = threshold - share;
            }
            let Some((i, _)) = next else { return };
            threshold = share;
            made |= 1 << i;
        }
    }

    /// Returns all levels in their order after all changes, active or not.
    pub(super) fn final_order(&self) -> &[Entry] {
        let made = self.changes.iter().enumerate();
        let made = made.filter(|(_, change)| change.share.target() > 0.0);
        let index: usize = made.map(|(i, _)| 1 << i).sum();
        self.plans.get(index).map_or(&[], |plan| &plan.order)
    }

    pub(super) fn activation(&self, id: LevelId) -> Option<f64> {
        let difference = Difference::Activation(id);
        if let Some(change) = self.changes.iter().find(|change| change.difference == difference) {
            return Some(change.share.value());
        }
        let order = self.plans.first().map_or(&[][..], |plan| &plan.order);
        let entry = order.iter().find(|entry| entry.id == id)?;
        Some(if entry.active { 1.0 } else { 0.0 })
    }

    /// Inserts an inactive level.
    pub(super) fn insert(&mut self, id: LevelId, place: Place) {
        for Plan { order, .. } in &mut self.plans {
            let of = |id| order.iter().position(|entry| entry.id == id).unwrap_or(0);
            let index = match place {
                Place::Top => 0,
                Place::Bottom => order.len(),
                Place::Above(neighbour) => of(neighbour),
                Place::Below(neighbour) => of(neighbour) + 1,
            };
            order.insert(index.min(order.len()), Entry { id, active: false });
        }
    }

    /// Doubles the plans: without the change, and with it. Existing plans keep the state of their
    /// solvers.
    pub(super) fn begin(&mut self, change: Change, data: &Data) -> Result<(), Error> {
        let apply = |made: bool, order: &[Entry]| {
            let mut order = order.to_vec();
            change.difference.apply(made, &mut order);
            order
        };
        let is_made = self.plans.iter().any(|plan| apply(false, &plan.order) != plan.order);
        let others: Vec<_> = self
            .plans
            .iter()
            .map(|plan| Plan::new(apply(!is_made, &plan.order), data, self.settings))
            .collect::<Result<_, _>>()?;
        if is_made {
            self.plans.splice(0..0, others);
        } else {
            self.plans.extend(others);
        }
        self.changes.push(change);
        Ok(())
    }

    /// Removes completed changes, the plans that these exclude, and the levels that they removed.
    /// Calls `removed` for each such level.
    pub(super) fn settle(&mut self, mut removed: impl FnMut(LevelId)) {
        for i in (0..self.changes.len()).rev() {
            let Some(made) = self.changes[i].outcome() else { continue };
            let change = self.changes.remove(i);
            let mut index = 0;
            self.plans.retain(|_| {
                let keeps = (index & (1 << i) != 0) == made;
                index += 1;
                keeps
            });
            if let Difference::Activation(id) = change.difference
                && change.removes(id)
            {
                for plan in &mut self.plans {
                    plan.order.retain(|entry| entry.id != id);
                }
                removed(id);
            }
        }
    }
}
