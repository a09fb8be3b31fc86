//! The forward pass for one input size: where every activation lives, and what runs on it.

use crate::Error;
use crate::kernels::{Buffer, Direct, Epilogue, InstructionSet, MaxPool, Pool, Winograd};
use crate::layout::{Extent, Layout};

use super::graph::{Graph, Step, Value};
use super::memory::{Memory, Place, place};
use super::parameters::Packed;
use super::shapes::{Algorithm, layouts, sizes};

/// A step with all that it needs but numbers.
#[derive(Clone, Debug)]
enum Planned {
    /// Makes the border of a value zero.
    Clear {
        at: Place,
    },
    Direct {
        plan: Direct,
        layer: usize,
        input: usize,
        output: usize,
        epilogue: Epilogue,
    },
    Winograd {
        plan: Winograd,
        layer: usize,
        input: usize,
        output: usize,
        epilogue: Epilogue,
    },
    MaxPool {
        plan: MaxPool,
        input: usize,
        output: usize,
    },
}

/// The steps of a network, or of a part of it, for one input size, with the memory that they work
/// in. Running it allocates nothing.
#[derive(Debug)]
pub(crate) struct Plan {
    steps: Vec<Planned>,
    buffers: Vec<Buffer>,
    scratch: Buffer,
    inputs: Vec<Place>,
    outputs: Vec<Place>,
}

impl Plan {
    /// Plans the steps from `inputs` to `outputs`.
    ///
    /// # Errors
    /// [`Error::InputTooSmall`] if a kernel does not fit, [`Error::Layer`] for a step that does not fit
    /// the others.
    pub(crate) fn new(
        isa: InstructionSet,
        lanes: usize,
        graph: &Graph,
        steps: &[Step],
        packed: &[Packed],
        inputs: &[(Value, Extent)],
        outputs: &[Value],
    ) -> Result<Self, Error> {
        let sizes = sizes(graph, steps, inputs)?;
        let inputs: Vec<Value> = inputs.iter().map(|&(value, _)| value).collect();
        let algorithms: Vec<Algorithm> = packed.iter().map(|packed| packed.algorithm).collect();
        let layouts = layouts(graph, steps, &sizes, &algorithms);
        let Memory { places, lengths, clear } = place(steps, &layouts, &inputs, outputs);
        let mut planned = Vec::with_capacity(steps.len());
        let mut scratch = 0;
        for (at, step) in steps.iter().enumerate() {
            planned.extend(
                clear.iter().filter(|(step, _)| *step == at).map(|&(_, at)| Planned::Clear { at }),
            );
            let input = placed(&places, step.input(), &step.name(&graph.layers))?;
            let output = placed(&places, step.output(), &step.name(&graph.layers))?;
            let window = step.window(&graph.layers);
            planned.push(match *step {
                Step::MaxPool { .. } => Planned::MaxPool {
                    plan: MaxPool::new(isa, window, input.layout, output.layout),
                    input: input.buffer,
                    output: output.buffer,
                },
                Step::Convolution { layer, first_channel, add, relu, .. } => {
                    let epilogue = Epilogue { add, relu };
                    let panels = packed[layer].panels;
                    let from = (input.layout, graph.layers[layer].inputs);
                    let (input, to) = (input.buffer, output.layout);
                    let output = output.buffer;
                    match packed[layer].algorithm {
                        Algorithm::Direct => {
                            let plan = Direct::new(isa, panels, window, from, (to, first_channel));
                            Planned::Direct { plan, layer, input, output, epilogue }
                        }
                        Algorithm::Winograd(tiling) => {
                            let plan = Winograd::new(
                                isa,
                                panels,
                                tiling,
                                from,
                                (to, first_channel),
                                lanes,
                            );
                            scratch = scratch.max(plan.scratch(lanes));
                            Planned::Winograd { plan, layer, input, output, epilogue }
                        }
                    }
                }
            });
        }
        let ends = |values: &[Value], name| {
            values.iter().map(|&value| placed(&places, value, name)).collect::<Result<_, _>>()
        };
        Ok(Self {
            inputs: ends(&inputs, "input")?,
            outputs: ends(outputs, "output")?,
            steps: planned,
            buffers: lengths.into_iter().map(Buffer::zeroed).collect(),
            scratch: Buffer::zeroed(scratch),
        })
    }

    /// The layout and memory of each input.
    pub(crate) fn input(&mut self, index: usize) -> (&Layout, &mut [f32]) {
        let Place { buffer, layout } = &self.inputs[index];
        (layout, &mut self.buffers[*buffer])
    }

    /// The layout and memory of each output.
    pub(crate) fn outputs(&self) -> impl Iterator<Item = (&Layout, &[f32])> {
        self.outputs.iter().map(|place| (&place.layout, &*self.buffers[place.buffer]))
    }

    /// Runs all steps.
    pub(crate) fn run(&mut self, pool: &mut Pool, packed: &[Packed]) {
        let Self { steps, buffers, scratch, .. } = self;
        for step in steps {
            match step {
                Planned::Clear { at } => at.layout.clear_border(&mut buffers[at.buffer]),
                Planned::Direct { plan, layer, input, output, epilogue } => {
                    let Packed { weights, bias, .. } = &packed[*layer];
                    let (input, output) = both(buffers, *input, *output);
                    plan.run(pool, input, weights, bias, output, *epilogue);
                }
                Planned::Winograd { plan, layer, input, output, epilogue } => {
                    let Packed { weights, bias, .. } = &packed[*layer];
                    let (input, output) = both(buffers, *input, *output);
                    plan.run(pool, input, weights, bias, output, scratch, *epilogue);
                }
                Planned::MaxPool { plan, input, output } => {
                    let (input, output) = both(buffers, *input, *output);
                    plan.run(pool, input, output);
                }
            }
        }
    }
}

/// A value's place.
fn placed(places: &[Option<Place>], Value(value): Value, layer: &str) -> Result<Place, Error> {
    let place = places.get(value).copied().flatten();
    place.ok_or_else(|| Error::Layer {
        layer: layer.into(),
        problem: "no step reads or writes its activation".into(),
    })
}

/// A step's input and output, which [`sizes`] has found to be two values; one is alive while the
/// other is written, so that they have two buffers.
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
