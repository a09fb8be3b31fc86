//! Compares random networks of the engine's layers with the layers' definitions.
//!
//! The definitions are PyTorch's, in f64. All values are kept: nothing is fused, shared or computed
//! in place.

use ndarray::{Array4, Array5, s};
use proptest::prelude::*;
use vision_models::engine::{Activation, Convolution, Graph, Network, Value, Window};
use vision_models::{Options, Tensors};

use crate::support::{input, weights};

/// An activation: channels × frames × rows × columns.
type Map = Array4<f64>;

/// One layer. Its operands are the numbers of previous values, modulo the number of values.
#[derive(Clone, Debug)]
enum Operation {
    Convolution {
        input: usize,
        layer: Layer,
        shortcut: Option<usize>,
    },
    MaxPool {
        input: usize,
    },
    Concatenation {
        parts: Vec<usize>,
    },
    /// A convolution of stride two, and back by a transposed convolution.
    DownAndUp {
        input: usize,
        outputs: usize,
    },
}

#[derive(Clone, Debug)]
struct Layer {
    kernel: [usize; 3],
    dilation: [usize; 3],
    /// Number of output channels of a group. The number of groups divides the number of input
    /// channels.
    outputs: usize,
    groups: usize,
    bias: bool,
    norm: bool,
    activation: usize,
}

fn layers() -> impl Strategy<Value = Layer> {
    let kernels = prop_oneof![
        Just([1, 1, 1]),
        Just([1, 3, 3]),
        Just([3, 1, 1]),
        Just([1, 5, 3]),
        Just([3, 3, 3])
    ];
    let outputs = prop_oneof![1..8_usize, Just(16), Just(32)];
    (kernels, 1..=2_usize, outputs, 1..=4_usize, any::<[bool; 2]>(), 0..4_usize).prop_map(
        |(kernel, dilation, outputs, groups, [bias, norm], activation)| {
            let dilation = [1, dilation, dilation];
            Layer { kernel, dilation, outputs, groups, bias, norm, activation }
        },
    )
}

fn operations() -> impl Strategy<Value = Vec<Operation>> {
    let convolution = (any::<usize>(), layers(), prop::option::of(any::<usize>()))
        .prop_map(|(input, layer, shortcut)| Operation::Convolution { input, layer, shortcut });
    let pool = any::<usize>().prop_map(|input| Operation::MaxPool { input });
    let parts = prop::collection::vec(any::<usize>(), 1..4);
    let concatenation = parts.prop_map(|parts| Operation::Concatenation { parts });
    let down = (any::<usize>(), prop_oneof![1..6_usize, Just(16)])
        .prop_map(|(input, outputs)| Operation::DownAndUp { input, outputs });
    prop::collection::vec(
        prop_oneof![5 => convolution, 1 => pool, 3 => concatenation, 1 => down],
        1..8,
    )
}

/// A network under construction: the engine's graph, and the values by definition.
struct Twin {
    graph: Graph,
    values: Vec<Value>,
    /// The definition of each value, for the second pass, when there are weights.
    definitions: Vec<Definition>,
}

enum Definition {
    Input,
    Convolution { name: String, input: usize, layer: Layer, groups: usize, shortcut: Option<usize> },
    MaxPool { input: usize },
    Concatenation { parts: Vec<usize> },
    DownAndUp { name: String, input: usize },
}

impl Twin {
    fn of(operations: &[Operation], channels: usize) -> Self {
        let mut graph = Graph::new();
        let values = vec![graph.input(channels)];
        let mut twin = Self { graph, values, definitions: vec![Definition::Input] };
        for (index, operation) in operations.iter().enumerate() {
            twin.add(&format!("layer{index}"), operation);
        }
        twin
    }

    fn push(&mut self, value: Value, definition: Definition) {
        self.values.push(value);
        self.definitions.push(definition);
    }

    fn add(&mut self, name: &str, operation: &Operation) {
        let count = self.values.len();
        match operation {
            Operation::Convolution { input, layer, shortcut } => {
                let (input, shortcut) = (input % count, shortcut.map(|shortcut| shortcut % count));
                let inputs = self.graph.channels(self.values[input]);
                // The shortcut fixes the number of channels, if there is one.
                let added = shortcut.map(|shortcut| self.graph.channels(self.values[shortcut]));
                let fits = |groups: usize| {
                    inputs.is_multiple_of(groups)
                        && added.is_none_or(|added| added.is_multiple_of(groups))
                };
                let groups = if layer.groups == 4 && fits(inputs) { inputs } else { layer.groups };
                let groups = if fits(groups) { groups } else { 1 };
                let outputs = added.unwrap_or(layer.outputs * groups);
                let mut convolution = Convolution::clip(name, outputs, layer.kernel)
                    .dilation(layer.dilation)
                    .groups(groups)
                    .activation(activation(name, layer.activation));
                if layer.bias {
                    convolution = convolution.bias();
                }
                if layer.norm {
                    convolution = convolution.norm(format!("{name}.norm"));
                }
                let value = match shortcut {
                    None => self.graph.convolution(self.values[input], convolution),
                    Some(shortcut) => {
                        self.graph.residual(self.values[input], convolution, self.values[shortcut])
                    }
                };
                let (name, layer) = (name.to_owned(), layer.clone());
                self.push(value, Definition::Convolution { name, input, layer, groups, shortcut });
            }
            Operation::MaxPool { input } => {
                let input = input % count;
                let value = self.graph.max_pool(self.values[input], Window::same([1, 3, 3]));
                self.push(value, Definition::MaxPool { input });
            }
            Operation::Concatenation { parts } => {
                let mut parts: Vec<usize> = parts.iter().map(|part| part % count).collect();
                // The definition is slow, so only narrow parts are concatenated.
                let narrow = |part: &usize| self.graph.channels(self.values[*part]) <= 24;
                let wide = parts.iter().find(|part| !narrow(part)).copied();
                parts.retain(narrow);
                parts = if parts.is_empty() { wide.into_iter().collect() } else { parts };
                let values: Vec<Value> = parts.iter().map(|&part| self.values[part]).collect();
                let value = self.graph.concatenation(&values);
                self.push(value, Definition::Concatenation { parts });
            }
            Operation::DownAndUp { input, outputs } => {
                let input = input % count;
                let layer =
                    Convolution::image(format!("{name}.down"), 16, [3, 3]).stride([1, 2, 2]);
                let small = self.graph.convolution(self.values[input], layer);
                // The small activation has another size than all others, so only the next layer
                // reads it.
                let layer = Convolution::transposed_image(format!("{name}.up"), *outputs, [4, 4])
                    .stride([1, 2, 2])
                    .padding([0, 1, 1]);
                let value = self.graph.convolution(small, layer);
                self.push(value, Definition::DownAndUp { name: name.to_owned(), input });
            }
        }
    }

    /// Computes all values by definition.
    fn evaluate(&self, clip: &Map, weights: &Tensors) -> Vec<Map> {
        let mut maps: Vec<Map> = Vec::new();
        for definition in &self.definitions {
            let map = match definition {
                Definition::Input => clip.clone(),
                Definition::Convolution { name, input, layer, groups, shortcut } => {
                    let kernel = tensor(weights, &format!("{name}.weight"));
                    let bias = layer.bias.then(|| tensor(weights, &format!("{name}.bias")).1);
                    let mut sum = convolution(&maps[*input], &kernel, layer.dilation, *groups, 1);
                    for (channel, mut map) in sum.outer_iter_mut().enumerate() {
                        let bias = bias.as_ref().map_or(0.0, |bias| bias[channel]);
                        map.mapv_inplace(|value| value + bias);
                        if layer.norm {
                            let part =
                                |part| tensor(weights, &format!("{name}.norm.{part}")).1[channel];
                            let (mean, variance) = (part("running_mean"), part("running_var"));
                            let (gain, shift) = (part("weight"), part("bias"));
                            map.mapv_inplace(|value| {
                                (value - mean) / (variance + 1e-5).sqrt() * gain + shift
                            });
                        }
                    }
                    if let Some(shortcut) = shortcut {
                        sum += &maps[*shortcut];
                    }
                    activate(sum, name, layer.activation, weights)
                }
                Definition::MaxPool { input } => max_pool(&maps[*input]),
                Definition::Concatenation { parts } => {
                    let parts: Vec<_> = parts.iter().map(|&part| maps[part].view()).collect();
                    ndarray::concatenate(ndarray::Axis(0), &parts).unwrap()
                }
                Definition::DownAndUp { name, input } => {
                    let [down, up] = ["down", "up"]
                        .map(|part| tensor(weights, &format!("{name}.{part}.weight")));
                    transposed(&convolution(&maps[*input], &down, [1; 3], 1, 2), &up)
                }
            };
            maps.push(map);
        }
        maps
    }
}

fn activation(name: &str, which: usize) -> Activation {
    let slopes = || format!("{name}.slopes");
    match which {
        0 => Activation::None,
        1 => Activation::Relu,
        which => Activation::Prelu { name: slopes(), shared: which == 3 },
    }
}

fn activate(mut sum: Map, name: &str, which: usize, weights: &Tensors) -> Map {
    for (channel, mut map) in sum.outer_iter_mut().enumerate() {
        let slope = match which {
            0 => continue,
            1 => 0.0,
            2 => tensor(weights, &format!("{name}.slopes.weight")).1[channel],
            _ => tensor(weights, &format!("{name}.slopes.weight")).1[0],
        };
        map.mapv_inplace(|value| if value > 0.0 { value } else { slope * value });
    }
    sum
}

/// Returns a tensor's shape and elements.
fn tensor(weights: &Tensors, name: &str) -> (Vec<usize>, Vec<f64>) {
    let tensor = weights.get(name).unwrap();
    (tensor.shape().to_vec(), tensor.data().iter().map(|&value| f64::from(value)).collect())
}

/// Padding keeps the size, except for the spatial stride.
fn convolution(
    from: &Map,
    (shape, kernel): &(Vec<usize>, Vec<f64>),
    dilation: [usize; 3],
    groups: usize,
    stride: usize,
) -> Map {
    let (inputs, frames, rows, columns) = from.dim();
    let taps =
        if shape.len() == 4 { [1, shape[2], shape[3]] } else { [shape[2], shape[3], shape[4]] };
    let (outputs, of_group) = (shape[0], inputs / groups);
    let padding: [usize; 3] = std::array::from_fn(|axis| taps[axis] / 2 * dilation[axis]);
    let size = (outputs, frames, rows.div_ceil(stride), columns.div_ceil(stride));
    Map::from_shape_fn(size, |(output, t, y, x)| {
        let mut sum = 0.0;
        for input in 0..of_group {
            let source =
                from.index_axis(ndarray::Axis(0), output / (outputs / groups) * of_group + input);
            for dt in 0..taps[0] {
                for dy in 0..taps[1] {
                    for dx in 0..taps[2] {
                        let at = [
                            (t + dt * dilation[0]).wrapping_sub(padding[0]),
                            (y * stride + dy * dilation[1]).wrapping_sub(padding[1]),
                            (x * stride + dx * dilation[2]).wrapping_sub(padding[2]),
                        ];
                        let tap = ((output * of_group + input) * taps[0] + dt) * taps[1] + dy;
                        sum += source.get(at).unwrap_or(&0.0) * kernel[tap * taps[2] + dx];
                    }
                }
            }
        }
        sum
    })
}

/// A 4×4 kernel, stride 2, padding 1: every input adds its kernel to the output.
fn transposed(from: &Map, (shape, kernel): &(Vec<usize>, Vec<f64>)) -> Map {
    let (inputs, frames, rows, columns) = from.dim();
    let mut to = Map::zeros((shape[1], frames, 2 * rows + 2, 2 * columns + 2));
    for ((input, t, y, x), value) in from.indexed_iter() {
        for output in 0..shape[1] {
            for tap in 0..16 {
                to[[output, t, 2 * y + tap / 4, 2 * x + tap % 4]] +=
                    value * kernel[(input * shape[1] + output) * 16 + tap];
            }
        }
    }
    assert_eq!(inputs, shape[0]);
    to.slice(s![.., .., 1..=2 * rows, 1..=2 * columns]).to_owned()
}

fn max_pool(from: &Map) -> Map {
    let (_, _, rows, columns) = from.dim();
    Map::from_shape_fn(from.dim(), |(channel, t, y, x)| {
        let ys = y.saturating_sub(1)..(y + 2).min(rows);
        let xs = x.saturating_sub(1)..(x + 2).min(columns);
        from.slice(s![channel, t, ys, xs]).fold(f64::NEG_INFINITY, |most, &value| most.max(value))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Every value may be an output, read several times, part of several concatenations, and a
    /// shortcut.
    #[test]
    fn networks_agree_with_the_definition_of_their_layers(
        operations in operations(),
        channels in prop_oneof![Just(3_usize), Just(16)],
        [frames, rows, columns] in [1..4_usize, 2..6, 2..5],
        ends in prop::collection::vec(any::<usize>(), 1..4),
        threads in 1..3_usize,
    ) {
        // Even sizes, for the stride of two and back.
        let (rows, columns) = (2 * rows, 2 * columns);
        let mut twin = Twin::of(&operations, channels);
        let ends: Vec<usize> = ends.iter().map(|end| end % twin.values.len()).collect();
        for &end in &ends {
            twin.graph.output(twin.values[end]);
        }
        let tensors = weights(Network::parameters(&twin.graph, 0)?);
        let clips: Array5<f32> = input((2, channels, frames, rows, columns));
        let options = Options { threads, ..Options::default() };
        let mut network =
            Network::load(&twin.graph, tensors.clone(), [frames, rows, columns], options)?;
        // Two inferences, because the state of the first must not change the second.
        network.infer(clips.view())?;
        let inference = network.infer(clips.view())?;
        for clip in 0..2 {
            let values = twin.evaluate(&clips.slice(s![clip, .., .., .., ..]).mapv(f64::from), &tensors);
            for (index, &end) in ends.iter().enumerate() {
                let expected = &values[end];
                let map = inference.map(index).unwrap();
                let map = map.index_axis(ndarray::Axis(0), clip);
                prop_assert_eq!(map.dim(), expected.dim());
                let largest = values.iter().flatten().fold(1e-3_f64, |most, value| most.max(value.abs()));
                for (&value, expected) in map.iter().zip(expected) {
                    let error = (f64::from(value) - expected).abs() / largest;
                    prop_assert!(error <= 2e-5, "{value} instead of {expected}");
                }
            }
        }
    }
}
