//! The forward pass for one input size: the place of every activation, and the steps.

use crate::error::Error;
use crate::kernels::{
    Buffer, Copy, Depthwise, Direct, Epilogue, InstructionSet, MaxPool, Pool, Resize, Winograd,
};
use crate::layout::{Channels, Extent};

use super::input::too_large;
use super::memory::{Memory, Place, place};
use super::packed::Packed;
use super::program::{Program, Slot, Step};
use super::shapes::{Algorithm, channels, layouts, sizes};

/// A planned convolution without its weights.
#[derive(Clone, Debug)]
enum Convolution {
    /// One plan for each phase.
    Direct(Vec<Direct>),
    Depthwise(Depthwise),
    Winograd(Winograd),
}

/// The computation of a step.
#[derive(Clone, Debug)]
enum Work {
    Convolution { plan: Convolution, layer: usize, add: bool },
    MaxPool(MaxPool),
    Copy(Copy),
    Resize(Resize),
}

/// A step with the buffers that it reads and writes.
#[derive(Clone, Debug)]
struct Planned {
    /// An activation whose border is first set to zero.
    clear: Option<Place>,
    work: Work,
    input: usize,
    output: usize,
}

/// The steps of a network, or of a part of it, for one input size, with their memory. Running it
/// allocates nothing.
#[derive(Debug)]
pub(crate) struct Plan {
    steps: Vec<Planned>,
    buffers: Vec<Buffer>,
    scratch: Buffer,
    inputs: Vec<(Channels, usize)>,
    outputs: Vec<(Channels, usize)>,
}

impl Plan {
    /// Plans the steps from `inputs` to `outputs`.
    ///
    /// # Errors
    /// - [`Error::Size`] if a kernel does not fit or there is not enough memory.
    /// - [`Error::Layer`] if a step does not fit the others.
    pub(crate) fn new(
        isa: InstructionSet,
        lanes: usize,
        program: &Program,
        steps: &[Step],
        packed: &[Packed],
        inputs: &[(Slot, Extent)],
        outputs: &[Slot],
    ) -> Result<Self, Error> {
        let sizes = sizes(program, steps, inputs)?;
        let refuse = || too_large(inputs.first().map_or([0; 3], |input| input.1));
        let inputs: Vec<Slot> = inputs.iter().map(|&(slot, _)| slot).collect();
        let algorithms: Vec<Algorithm> = packed.iter().map(|packed| packed.algorithm).collect();
        let layouts = layouts(program, steps, &sizes, &algorithms);
        if layouts.iter().flatten().any(|layout| layout.checked_length().is_none()) {
            return Err(refuse());
        }
        let Memory { places, lengths, clear } = place(steps, &layouts, &inputs, outputs);
        let find = |slot: Slot, name: &str| -> Result<(Channels, usize), Error> {
            let place =
                places.get(slot.activation).copied().flatten().ok_or_else(|| Error::Layer {
                    layer: name.into(),
                    problem: "no step reads or writes its activation".into(),
                })?;
            Ok((channels(slot, place.layout), place.buffer))
        };
        let mut planned = Vec::with_capacity(steps.len());
        let mut scratch = 0;
        for (at, step) in steps.iter().enumerate() {
            let clear = clear.iter().find(|(step, _)| *step == at).map(|&(_, place)| place);
            let name = step.name(&program.layers);
            let ((from, input), (to, output)) =
                (find(step.input(), &name)?, find(step.output(), &name)?);
            let work = match *step {
                Step::MaxPool { window, .. } => Work::MaxPool(MaxPool::new(isa, window, from, to)),
                Step::Copy { .. } | Step::Reshape { .. } => Work::Copy(Copy::new(from, to)),
                Step::Resize { alignment, .. } => {
                    Work::Resize(Resize::new(isa, alignment, from, to))
                }
                Step::Convolution { layer, add, .. } => {
                    let plan = plan(isa, lanes, (program, layer), &packed[layer], from, to);
                    if let Convolution::Winograd(plan) = &plan {
                        scratch = scratch.max(plan.scratch(lanes));
                    }
                    Work::Convolution { plan, layer, add }
                }
            };
            planned.push(Planned { clear, work, input, output });
        }
        let ends = |slots: &[Slot], name| {
            slots.iter().map(|&slot| find(slot, name)).collect::<Result<_, _>>()
        };
        let memory = |length| Buffer::try_zeroed(length).ok_or_else(refuse);
        Ok(Self {
            inputs: ends(&inputs, "input")?,
            outputs: ends(outputs, "output")?,
            steps: planned,
            buffers: lengths.into_iter().map(memory).collect::<Result<_, _>>()?,
            scratch: memory(scratch)?,
        })
    }

    /// Returns the channels and the memory of an input.
    pub(crate) fn input(&mut self, index: usize) -> (&Channels, &mut [f32]) {
        let (channels, buffer) = &self.inputs[index];
        (channels, &mut self.buffers[*buffer])
    }

    /// Returns the channels and the memory of each output.
    pub(crate) fn outputs(&self) -> impl Iterator<Item = (&Channels, &[f32])> {
        self.outputs.iter().map(|(channels, buffer)| (channels, &*self.buffers[*buffer]))
    }

    /// Runs all steps.
    pub(crate) fn run(&mut self, pool: &mut Pool, packed: &[Packed]) {
        let Self { steps, buffers, scratch, .. } = self;
        for step in steps {
            let Planned { clear, work, input, output } = step;
            if let Some(Place { buffer, layout }) = clear {
                layout.clear_border(&mut buffers[*buffer]);
            }
            let (input, output) = both(buffers, *input, *output);
            match work {
                Work::MaxPool(plan) => plan.run(pool, input, output),
                Work::Copy(plan) => plan.run(pool, input, output),
                Work::Resize(plan) => plan.run(pool, input, output),
                Work::Convolution { plan, layer, add } => {
                    let packed = &packed[*layer];
                    let epilogue = Epilogue { add: *add, finish: packed.finish() };
                    match plan {
                        Convolution::Direct(phases) => {
                            for (phase, plan) in phases.iter().enumerate() {
                                plan.run(pool, packed.operands(phase, input), output, epilogue);
                            }
                        }
                        Convolution::Depthwise(plan) => {
                            plan.run(pool, packed.operands(0, input), output, epilogue);
                        }
                        Convolution::Winograd(plan) => {
                            plan.run(pool, packed.operands(0, input), output, scratch, epilogue);
                        }
                    }
                }
            }
        }
    }
}

/// Plans one convolution for the way in which its weights are packed.
fn plan(
    isa: InstructionSet,
    lanes: usize,
    (program, layer): (&Program, usize),
    packed: &Packed,
    from: Channels,
    to: Channels,
) -> Convolution {
    let super::layer::Convolution { window, transposed, .. } = program.layers[layer].convolution;
    let made = to.layout.size;
    match packed.algorithm {
        Algorithm::Direct => {
            let phases = if transposed { window.phases(made) } else { vec![window.whole(made)] };
            let plan = |phase| Direct::new(isa, packed.panels, phase, from, to);
            Convolution::Direct(phases.iter().map(plan).collect())
        }
        Algorithm::Depthwise => {
            Convolution::Depthwise(Depthwise::new(isa, &window.whole(made), from, to))
        }
        Algorithm::Winograd(tiling) => {
            Convolution::Winograd(Winograd::new(isa, packed.panels, tiling, from, to, lanes))
        }
    }
}

/// Returns a step's input and output. Both activations are needed at the same time, so they have
/// different buffers.
fn both(buffers: &mut [Buffer], input: usize, output: usize) -> (&[f32], &mut [f32]) {
    assert_ne!(input, output, "a step reads and writes one buffer");
    if input < output {
        let (before, from) = buffers.split_at_mut(output);
        (&before[input], &mut from[0])
    } else {
        let (before, from) = buffers.split_at_mut(input);
        (&from[0], &mut before[output])
    }
}
