//! Attachment of payloads.

use super::data::Data;
use super::payload::{Payload, PayloadId};
use crate::error::Error;
use crate::robot::description::Base;
use crate::robot::model::Model;

impl Data {
    /// Adds a payload to the dynamics until [`detach`](Self::detach) removes it.
    ///
    /// The model does not change. It can be shared by threads whose robots carry different payloads. Attaching
    /// allocates nothing.
    ///
    /// # Errors
    /// [`Error::ForeignData`]; [`Error::ForeignId`] for a frame of another model;
    /// [`Error::Value`]; [`Error::TooManyPayloads`] above eight.
    pub fn attach(&mut self, model: &Model, payload: &Payload) -> Result<PayloadId, Error> {
        self.check(model)?;
        let (id, body) = self.payloads.add(model, payload)?;
        self.update_inertia(model, body);
        Ok(id)
    }

    /// Removes a payload.
    ///
    /// # Errors
    /// [`Error::ForeignData`]; [`Error::ForeignId`] if it is not attached.
    pub fn detach(&mut self, model: &Model, payload: PayloadId) -> Result<(), Error> {
        self.check(model)?;
        let body = self.payloads.remove(model, payload)?;
        self.update_inertia(model, body);
        Ok(())
    }

    /// Sums up a body and its payloads anew, so that nothing is ever subtracted.
    fn update_inertia(&mut self, model: &Model, body: usize) {
        // Payloads on the world do not count in the dynamics.
        if body > 0 || model.base == Base::Floating {
            self.inertias[body] = self.payloads.on(body, &model.inertias[body]);
        }
    }
}
