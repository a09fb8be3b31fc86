//! Decides which activations share memory.

use crate::layout::Layout;

use super::program::{Slot, Step};

/// The place of an activation in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) buffer: usize,
    pub(crate) layout: Layout,
}

/// The places of all activations, and the buffers.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    /// The place of each activation that the steps use.
    pub(crate) places: Vec<Option<Place>>,
    /// The length of each buffer.
    pub(crate) lengths: Vec<usize>,
    /// The steps before which a border must be set to zero, because another activation used the
    /// memory.
    pub(crate) clear: Vec<(usize, Place)>,
}

/// A buffer that several activations use one after the other.
#[derive(Debug)]
struct Shared {
    length: usize,
    taken: bool,
    /// Number of activations that have used it.
    lived: usize,
}

/// Gives every activation a place. Activations that are never needed at the same time share a
/// buffer. `inputs` and `outputs` keep their buffers between runs.
pub(crate) fn place(
    steps: &[Step],
    layouts: &[Option<Layout>],
    inputs: &[Slot],
    outputs: &[Slot],
) -> Memory {
    let mut last_use = vec![0; layouts.len()];
    for (at, step) in steps.iter().enumerate() {
        last_use[step.input().activation] = at;
        last_use[step.output().activation] = at;
    }
    for end in inputs.iter().chain(outputs) {
        last_use[end.activation] = usize::MAX;
    }
    let mut buffers = Vec::new();
    let mut places: Vec<Option<Place>> = vec![None; layouts.len()];
    for input in inputs {
        let layout = layouts[input.activation];
        places[input.activation] = layout.map(|layout| take(&mut buffers, layout));
    }
    let mut first_writes = Vec::new();
    for (at, step) in steps.iter().enumerate() {
        let written = step.output().activation;
        if places[written].is_none() {
            places[written] = layouts[written].map(|layout| take(&mut buffers, layout));
            first_writes.extend(places[written].map(|place| (at, place)));
        }
        for slot in [step.input(), step.output()] {
            if let Some(place) = places[slot.activation].filter(|_| last_use[slot.activation] == at)
            {
                buffers[place.buffer].taken = false;
            }
        }
    }
    // The border of an activation alone in its buffer stays zero.
    first_writes.retain(|(_, place)| place.layout.has_border() && buffers[place.buffer].lived > 1);
    let lengths = buffers.iter().map(|buffer| buffer.length).collect();
    Memory { places, lengths, clear: first_writes }
}

/// Takes the free buffer that fits best, or adds one.
fn take(buffers: &mut Vec<Shared>, layout: Layout) -> Place {
    let length = layout.length();
    let best = buffers
        .iter_mut()
        .enumerate()
        .filter(|(_, shared)| !shared.taken)
        .min_by_key(|(_, shared)| shared.length.abs_diff(length));
    let buffer = if let Some((buffer, shared)) = best {
        shared.length = shared.length.max(length);
        shared.taken = true;
        shared.lived += 1;
        buffer
    } else {
        buffers.push(Shared { length, taken: true, lived: 1 });
        buffers.len() - 1
    };
    Place { buffer, layout }
}
