//! Which activations share memory.

use crate::layout::Layout;

use super::graph::{Step, Value};

/// An activation's place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) buffer: usize,
    pub(crate) layout: Layout,
}

/// Where everything is.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    /// The place of each value that the steps touch.
    pub(crate) places: Vec<Option<Place>>,
    /// The length of each buffer.
    pub(crate) lengths: Vec<usize>,
    /// The steps before which a border must be made zero, as another value lived there.
    pub(crate) clear: Vec<(usize, Place)>,
}

/// A buffer that values take turns in.
#[derive(Debug)]
struct Slot {
    length: usize,
    taken: bool,
    /// Values that have lived here.
    values: usize,
}

/// Gives every value a place. Values that are never alive together share a buffer; `inputs` and
/// `outputs` keep theirs between runs.
pub(crate) fn place(
    steps: &[Step],
    layouts: &[Option<Layout>],
    inputs: &[Value],
    outputs: &[Value],
) -> Memory {
    let mut last_use = vec![0; layouts.len()];
    for (at, step) in steps.iter().enumerate() {
        last_use[step.input().0] = at;
        last_use[step.output().0] = at;
    }
    for end in inputs.iter().chain(outputs) {
        last_use[end.0] = usize::MAX;
    }
    let mut slots = Vec::new();
    let mut places: Vec<Option<Place>> = vec![None; layouts.len()];
    for input in inputs {
        places[input.0] = layouts[input.0].map(|layout| take(&mut slots, layout));
    }
    let mut first_writes = Vec::new();
    for (at, step) in steps.iter().enumerate() {
        let Value(written) = step.output();
        if places[written].is_none() {
            places[written] = layouts[written].map(|layout| take(&mut slots, layout));
            first_writes.extend(places[written].map(|place| (at, place)));
        }
        for value in [step.input(), step.output()] {
            if let Some(place) = places[value.0].filter(|_| last_use[value.0] == at) {
                slots[place.buffer].taken = false;
            }
        }
    }
    // Alone in its buffer, a border stays as it was made: zero.
    first_writes.retain(|(_, place)| place.layout.has_border() && slots[place.buffer].values > 1);
    Memory { places, lengths: slots.iter().map(|slot| slot.length).collect(), clear: first_writes }
}

/// Takes the free slot that fits best, or a new one.
fn take(slots: &mut Vec<Slot>, layout: Layout) -> Place {
    let length = layout.length();
    let best = slots
        .iter_mut()
        .enumerate()
        .filter(|(_, slot)| !slot.taken)
        .min_by_key(|(_, slot)| slot.length.abs_diff(length));
    let buffer = if let Some((buffer, slot)) = best {
        slot.length = slot.length.max(length);
        slot.taken = true;
        slot.values += 1;
        buffer
    } else {
        slots.push(Slot { length, taken: true, values: 1 });
        slots.len() - 1
    };
    Place { buffer, layout }
}
