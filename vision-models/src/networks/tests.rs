//! Graphs that no network of this crate has: concatenations by every kernel, and layers that cannot
//! be planned.

use crate::kernels::{InstructionSet, Pool, Tiling, Window};
use crate::layout::{Extent, offset, position};
use crate::{Error, Tensor, Tensors};

use super::graph::{Graph, Layer, Names, Value};
use super::parameters::Packed;
use super::plan::Plan;
use super::shapes::Algorithm;

const SIZE: Extent = [4, 9, 10];

fn layer(name: &str, [inputs, outputs]: [usize; 2], kernel: Extent) -> Layer {
    let names = Names { convolution: name.into(), norm: format!("{name}.norm") };
    let padding = kernel.map(|taps| taps / 2);
    let window = Window { kernel, stride: [1; 3], padding };
    Layer { names, inputs, outputs, window, axes: 3 }
}

/// Weights of a layer that differ from tap to tap and channel to channel.
fn packed(isa: InstructionSet, layer: &Layer, algorithm: Algorithm) -> Packed {
    let Layer { names, inputs, outputs, window, .. } = layer;
    let mut tensors = Tensors::new();
    let mut add = |name: String, shape: Vec<usize>, value: &dyn Fn(usize) -> f32| {
        let data = (0..shape.iter().product()).map(value).collect();
        tensors.insert(name, Tensor::new(shape, data)?)
    };
    let shape = [&[*outputs, *inputs][..], &window.kernel].concat();
    let wave = |index: usize| (index as f32 * 0.7).sin() * 0.1;
    add(format!("{}.weight", names.convolution), shape, &wave).unwrap();
    for (part, value) in
        [("weight", 1.0), ("bias", 0.1), ("running_mean", 0.2), ("running_var", 1.0)]
    {
        add(format!("{}.{part}", names.norm), vec![*outputs], &|_| value).unwrap();
    }
    Packed::convolution(isa, layer, algorithm, &mut tensors).unwrap()
}

/// What a plan makes of waves as input.
fn run(isa: InstructionSet, graph: &Graph, packed: &[Packed], ends: [Value; 2]) -> Vec<f32> {
    let [input, output] = ends;
    let mut plan =
        Plan::new(isa, 2, graph, &graph.steps, packed, &[(input, SIZE)], &[output]).unwrap();
    let (layout, memory) = plan.input(0);
    for pixel in 0..layout.pixels() {
        let start = layout.origin() + offset(position(pixel, SIZE), layout.strides());
        for channel in 0..layout.channels {
            memory[start + channel] = ((pixel * 31 + channel) as f32 * 0.3).cos();
        }
    }
    plan.run(&mut Pool::new(2).unwrap(), packed);
    let (layout, memory) = plan.outputs().next().unwrap();
    (0..layout.pixels())
        .flat_map(|pixel| {
            let start = layout.origin() + offset(position(pixel, SIZE), layout.strides());
            memory[start..start + layout.channels].to_vec()
        })
        .collect()
}

/// Two convolutions side by side in one activation are the two on their own, whatever computes them.
#[test]
fn a_concatenation_is_its_parts_side_by_side() {
    for isa in InstructionSet::available() {
        for (kernel, algorithm) in [
            ([1, 3, 3], Algorithm::Direct),
            ([1, 3, 3], Algorithm::Winograd(Tiling::Two)),
            ([1, 3, 3], Algorithm::Winograd(Tiling::Four)),
            ([3, 1, 1], Algorithm::Winograd(Tiling::FourFrames)),
        ] {
            let parts = [layer("a", [16, 32], kernel), layer("b", [16, 16], kernel)];
            let alone = parts.each_ref().map(|part| {
                let mut graph = Graph::default();
                let image = graph.value(16);
                let output = graph.convolve(image, part.clone(), true);
                run(isa, &graph, &[packed(isa, part, algorithm)], [image, output])
            });
            let mut graph = Graph::default();
            let (image, joined) = (graph.value(16), graph.value(48));
            let [first, second] = parts;
            let both = [packed(isa, &first, algorithm), packed(isa, &second, algorithm)];
            graph.convolve_into(image, second, joined, 32, true);
            graph.convolve_into(image, first, joined, 0, true);
            let [first, second] = &both;
            let joined = run(isa, &graph, &[second.clone(), first.clone()], [image, joined]);
            let expected: Vec<f32> = (alone[0].chunks(32).zip(alone[1].chunks(16)))
                .flat_map(|(one, other)| [one, other].concat())
                .collect();
            assert_eq!(joined, expected, "{algorithm:?} with {}", isa.name());
        }
    }
}

#[test]
fn layers_that_cannot_be_planned_are_errors() {
    let problem = |build: &dyn Fn(&mut Graph, Value) -> Value| {
        let isa = InstructionSet::detect();
        let mut graph = Graph::default();
        let image = graph.value(16);
        let output = build(&mut graph, image);
        let packed: Vec<_> =
            graph.layers.iter().map(|layer| packed(isa, layer, Algorithm::Direct)).collect();
        match Plan::new(isa, 1, &graph, &graph.steps, &packed, &[(image, SIZE)], &[output]) {
            Err(Error::Layer { layer, problem }) => (layer, problem),
            other => panic!("{other:?}"),
        }
    };
    let point = |channels| layer("point", channels, [1; 3]);
    let pool = Window { kernel: [1, 3, 3], stride: [1, 2, 2], padding: [0, 1, 1] };

    let (layer, said) = problem(&|graph, _| {
        let nothing = graph.value(16);
        graph.convolve(nothing, point([16, 16]), true)
    });
    assert_eq!((&*layer, &*said), ("point", "nothing has written its input"));
    let (_, said) = problem(&|graph, image| {
        graph.convolve_into(image, point([16, 16]), image, 0, true);
        image
    });
    assert_eq!(said, "it would overwrite its input");
    let (_, said) = problem(&|graph, image| graph.convolve(image, point([32, 16]), true));
    assert_eq!(said, "it takes 32 channels of an activation of 16");
    let (_, said) = problem(&|graph, image| {
        let output = graph.value(32);
        graph.convolve_into(image, point([16, 16]), output, 17, true);
        output
    });
    assert_eq!(said, "it takes 33 channels of an activation of 32");
    let (_, said) = problem(&|graph, image| {
        let output = graph.value(16);
        graph.convolve_add(image, point([16, 16]), output);
        output
    });
    assert_eq!(said, "nothing is there that it could add to");
    let (layer, said) = problem(&|graph, image| {
        let output = graph.convolve(image, point([16, 32]), true);
        graph.max_pool(image, output, pool);
        output
    });
    assert_eq!(layer, "max pool");
    assert_eq!(said, "its output of size [4, 5, 5] joins one of size [4, 9, 10]");
    let (layer, _) = problem(&|graph, image| {
        graph.convolve(image, point([16, 16]), true);
        graph.value(16)
    });
    assert_eq!(layer, "output");
}
