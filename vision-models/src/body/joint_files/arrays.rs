//! JSON arrays of which only a limited number of elements is kept.

use std::fmt;

use serde::{
    Deserialize, Deserializer,
    de::{IgnoredAny, SeqAccess, Visitor},
};
use serde_json::value::RawValue;

use super::of_syntax;
use crate::error::Error;

/// The first `MOST` elements of an array, as they stand in the text, and how many there are.
#[derive(Debug)]
pub(super) struct Bounded<'a, const MOST: usize> {
    pub(super) first: Vec<&'a RawValue>,
    pub(super) count: usize,
}

impl<'de: 'a, 'a, const MOST: usize> Deserialize<'de> for Bounded<'a, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Elements::<MOST>)
    }
}

struct Elements<const MOST: usize>;

impl<'de, const MOST: usize> Visitor<'de> for Elements<MOST> {
    type Value = Bounded<'de, MOST>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an array")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Self::Value, A::Error> {
        let mut first = Vec::new();
        while first.len() < MOST {
            let Some(element) = elements.next_element()? else {
                return Ok(Bounded { count: first.len(), first });
            };
            first.push(element);
        }
        let mut count = MOST;
        while elements.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        Ok(Bounded { first, count })
    }
}

/// Does something with each element of an array, one after the other, until it fails.
pub(super) fn for_each(
    array: &RawValue,
    mut each: impl FnMut(usize, &RawValue) -> Result<(), Error>,
) -> Result<(), Error> {
    let mut failed = None;
    let visitor = Each { each: &mut each, failed: &mut failed };
    let read = serde_json::Deserializer::from_str(array.get()).deserialize_seq(visitor);
    match (failed, read) {
        (Some(error), _) => Err(error),
        (None, Err(error)) => Err(of_syntax(&error)),
        (None, Ok(())) => Ok(()),
    }
}

struct Each<'a> {
    each: &'a mut dyn FnMut(usize, &RawValue) -> Result<(), Error>,
    failed: &'a mut Option<Error>,
}

impl<'de> Visitor<'de> for Each<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an array")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<(), A::Error> {
        let mut index = 0;
        while let Some(element) = elements.next_element::<&RawValue>()? {
            if let Err(error) = (self.each)(index, element) {
                *self.failed = Some(error);
                return Err(serde::de::Error::custom("an element"));
            }
            index += 1;
        }
        Ok(())
    }
}
