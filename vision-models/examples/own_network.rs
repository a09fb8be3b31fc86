//! A network of your own, built from the engine's layers: an encoder and decoder for object
//! detection.
//!
//! ```text
//! cargo run -p vision-models --example own_network [WEIGHTS]
//! ```
//!
//! WEIGHTS is a checkpoint with the names below, from `torch.save` or as safetensors. If it is
//! missing, all weights are 0.01.
#![allow(clippy::print_stdout, missing_docs)]

use std::{env, error::Error};

use ndarray::Array5;
use vision_models::engine::{
    Activation::{self, Relu},
    Convolution, Graph, Network, ThreadSettings, Threads, Value, Waiting, Window,
};
use vision_models::{Checkpoint, Options, Tensor, Tensors};

/// Returns a network with three input colours. It gives a score for each of five classes at every
/// fourth pixel.
fn objects() -> Graph {
    let mut graph = Graph::new();
    let image = graph.input(3);
    let stem = Convolution::image("stem", 32, [3, 3]).stride([1, 2, 2]).norm("stem_norm");
    let half = graph.convolution(image, stem.activation(Relu));
    let quarter = graph.max_pool(half, Window { stride: [1, 2, 2], ..Window::same([1, 3, 3]) });
    let quarter = separable(&mut graph, "encoder.0", quarter, 64);
    let small =
        Convolution::image("encoder.1", 128, [3, 3]).stride([1, 2, 2]).norm("encoder.1_norm");
    let eighth = graph.convolution(quarter, small.activation(Relu));
    // Wider, but without another stride.
    let wide = Convolution::image("context", 128, [3, 3]).dilation([1, 2, 2]).norm("context_norm");
    let eighth = graph.residual(eighth, wide.activation(Relu), eighth);
    let up = Convolution::transposed_image("up", 64, [4, 4])
        .stride([1, 2, 2])
        .padding([0, 1, 1])
        .norm("up_norm")
        .activation(Relu);
    let up = graph.convolution(eighth, up);
    let both = graph.concatenation(&[up, quarter]);
    let scores = graph.convolution(both, Convolution::image("scores", 5, [1, 1]).bias());
    graph.output(scores);
    graph
}

/// Adds a depthwise convolution, then one over all channels.
fn separable(graph: &mut Graph, name: &str, x: Value, outputs: usize) -> Value {
    let channels = graph.channels(x);
    let slopes =
        |part: &str| Activation::Prelu { name: format!("{name}.{part}_slopes"), shared: false };
    let each = Convolution::image(format!("{name}.depthwise"), channels, [3, 3])
        .groups(channels)
        .norm(format!("{name}.depthwise_norm"))
        .activation(slopes("depthwise"));
    let all = Convolution::image(format!("{name}.pointwise"), outputs, [1, 1])
        .norm(format!("{name}.pointwise_norm"))
        .activation(slopes("pointwise"));
    let x = graph.convolution(x, each);
    graph.convolution(x, all)
}

fn main() -> Result<(), Box<dyn Error>> {
    let graph = objects();
    let sizes = [[1, 240, 320], [1, 480, 640]];
    let options = Options::default();
    let mut network = match env::args().nth(1) {
        Some(path) => Network::load(&graph, Checkpoint::open(path)?, sizes[0], options)?,
        None => Network::load(&graph, constant(&graph)?, sizes[0], options)?,
    };
    network.plan(sizes[1])?;
    // Other networks can run on the same threads.
    let settings =
        ThreadSettings { threads: 2, waiting: Waiting::Parking, ..ThreadSettings::default() };
    network.share_threads(&Threads::new(&settings)?)?;
    for [frames, rows, columns] in sizes {
        let image = Array5::from_elem((1, 3, frames, rows, columns), 0.5);
        let inference = network.infer(image.view())?;
        if let Some(scores) = inference.map(0) {
            println!("{rows} × {columns} pixels give maps of {:?}", scores.dim());
        }
    }
    println!("{:.2} GFLOP for the first size", 1e-9 * network.operations() as f64);
    Ok(())
}

/// Returns meaningless weights, to show that the network runs.
fn constant(graph: &Graph) -> Result<Tensors, vision_models::Error> {
    let mut tensors = Tensors::new();
    for (name, shape) in Network::parameters(graph, 0)? {
        let elements = vec![0.01; shape.iter().product()];
        tensors.insert(name, Tensor::new(shape, elements)?)?;
    }
    Ok(tensors)
}
