//! Attaching payloads to what one thread computes.

use super::data::Data;
use super::payload::{Payload, PayloadId};
use crate::error::Error;
use crate::robot::description::Base;
use crate::robot::model::Model;

impl Data {
    /// Adds a payload to what all dynamics see, until [`detach`](Self::detach) takes it away.
    ///
    /// The model stays as it is and can be shared by threads whose robots carry different things.
    /// Picking something up allocates nothing.
    ///
    /// # Errors
    /// [`Error::ForeignData`]; [`Error::ForeignId`] for a frame of another model;
    /// [`Error::Value`]; [`Error::Value`]; [`Error::TooManyPayloads`] above eight.
    pub fn attach(&mut self, model: &Model, payload: &Payload) -> Result<PayloadId, Error> {
        self.check(model)?;
        let (id, body) = self.payloads.add(model, payload)?;
        self.weigh(model, body);
        Ok(id)
    }

    /// Takes a payload away.
    ///
    /// # Errors
    /// [`Error::ForeignData`]; [`Error::ForeignId`] if it is not attached.
    pub fn detach(&mut self, model: &Model, payload: PayloadId) -> Result<(), Error> {
        self.check(model)?;
        let body = self.payloads.remove(model, payload)?;
        self.weigh(model, body);
        Ok(())
    }

    /// Sums up a body and what is attached to it; nothing is ever subtracted.
    fn weigh(&mut self, model: &Model, body: usize) {
        // What is attached to the world has no part in motion.
        if body > 0 || model.base == Base::Floating {
            self.inertias[body] = self.payloads.on(body, &model.inertias[body]);
        }
    }
}
