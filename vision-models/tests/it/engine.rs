//! The abilities of user-defined networks, and the rejected inputs.

use ndarray::Array5;
use vision_models::engine::{
    Activation, Alignment, Convolution, Frames, Graph, Network, Pooling, ThreadSettings, Threads,
    Value, Waiting, Window,
};
use vision_models::{Error, Options};

use crate::support::{input, weights};

/// Returns three convolutions with an output and a head.
fn small() -> Graph {
    let mut graph = Graph::new();
    let image = graph.input(3);
    let layer = |name| Convolution::image(name, 32, [3, 3]).bias().activation(Activation::Relu);
    let x = graph.convolution(image, layer("a").stride([1, 2, 2]));
    let y = graph.convolution(x, layer("b"));
    let x = graph.residual(y, layer("c"), x);
    graph.output(x);
    graph.classify(&[(x, Pooling::Mean)], "classifier");
    graph
}

fn load(threads: usize) -> Network {
    let graph = small();
    let tensors = weights(Network::parameters(&graph, 4).unwrap());
    let options = Options { threads, ..Options::default() };
    Network::load(&graph, tensors, [1, 24, 32], options).unwrap()
}

fn bits(network: &mut Network, size: [usize; 2]) -> Vec<u32> {
    let image: Array5<f32> = input((1, 3, 1, size[0], size[1]));
    let inference = network.infer(image.view()).unwrap();
    let map = inference.map(0).unwrap();
    inference.scores().logits.iter().chain(&map).map(|value| value.to_bits()).collect()
}

#[test]
fn sizes_are_planned_side_by_side() {
    let mut network = load(1);
    let sizes = [[24, 32], [40, 16], [8, 8]];
    let expected = sizes.map(|size| bits(&mut load(1), size));
    network.plan([1, 40, 16]).unwrap();
    for _ in 0..2 {
        for (size, expected) in sizes.iter().zip(&expected) {
            assert_eq!(bits(&mut network, *size), *expected);
        }
    }
    let refused = network.plan([1, 0, 16]).unwrap_err();
    assert!(matches!(&refused, Error::Size { got, .. } if *got == [1, 0, 16]), "{refused}");
    assert!(refused.to_string().contains("too small"), "{refused}");
}

/// Networks on several threads take turns on the threads that they share.
#[test]
fn networks_share_threads() {
    let expected = bits(&mut load(1), [24, 32]);
    for waiting in [Waiting::Spinning, Waiting::Parking] {
        let settings = ThreadSettings { threads: 3, waiting, ..ThreadSettings::default() };
        let threads = Threads::new(&settings).unwrap();
        std::thread::scope(|scope| {
            for _ in 0..3 {
                scope.spawn(|| {
                    let mut network = load(1);
                    network.plan([1, 8, 8]).unwrap();
                    network.share_threads(&threads).unwrap();
                    for _ in 0..5 {
                        assert_eq!(bits(&mut network, [24, 32]), expected);
                    }
                });
            }
        });
    }
}

#[test]
fn thread_settings_that_cannot_be_are_refused() {
    let none = ThreadSettings { threads: 0, ..ThreadSettings::default() };
    assert!(matches!(Threads::new(&none), Err(Error::Threads { threads: 0, .. })));
    let far = ThreadSettings { threads: 2, cores: vec![1 << 20], ..ThreadSettings::default() };
    assert!(matches!(Threads::new(&far), Err(Error::Threads { threads: 2, .. })));
}

#[test]
fn frames_are_taken_as_each_library_takes_them() {
    let taken = |frames: Frames, given: usize| {
        let mut graph = Graph::new();
        let clip = graph.sampled_input(1, frames);
        let identity = graph.max_pool(clip, Window::same([1, 1, 1]));
        graph.output(identity);
        let options = Options::default();
        let mut network =
            Network::load(&graph, weights(Vec::new()), [given, 1, 1], options).unwrap();
        let numbers = (0..given).map(|frame| f32::from(u8::try_from(frame).unwrap()));
        let clip = Array5::from_shape_vec((1, 1, given, 1, 1), numbers.collect()).unwrap();
        let inference = network.infer(clip.view()).unwrap();
        inference.map(0).unwrap().iter().copied().collect::<Vec<_>>()
    };
    assert_eq!(taken(Frames::All, 3), [0.0, 1.0, 2.0]);
    // torch.linspace(0, 31, 8).long() and torch.arange(0, 32, 8)
    assert_eq!(taken(Frames::Spread(4), 32), [0.0, 4.0, 8.0, 13.0, 17.0, 22.0, 26.0, 31.0]);
    assert_eq!(taken(Frames::Every(8), 32), [0.0, 8.0, 16.0, 24.0]);
}

/// Returns the error of a graph.
fn problem(build: impl FnOnce(&mut Graph, Value) -> Value) -> String {
    let mut graph = Graph::new();
    let image = graph.input(16);
    let output = build(&mut graph, image);
    graph.output(output);
    let error = Network::parameters(&graph, 1).map(|parameters| {
        Network::load(&graph, weights(parameters), [4, 9, 10], Options::default())
    });
    match error {
        Err(error) | Ok(Err(error)) => error.to_string(),
        Ok(Ok(_)) => panic!("nothing is wrong"),
    }
}

#[test]
fn layers_that_cannot_be_planned_are_errors() {
    let point = |outputs| Convolution::clip("point", outputs, [1; 3]);
    let square = || Convolution::image("square", 16, [3, 3]);
    let cases: [(String, &str); 15] = [
        (
            problem(|graph, image| graph.convolution(image, point(0))),
            "point cannot be planned: 0 channels",
        ),
        (
            problem(|graph, image| graph.convolution(image, point(usize::MAX))),
            "18446744073709551615 channels",
        ),
        (
            problem(|graph, image| graph.convolution(image, point(16).groups(3))),
            "3 groups do not divide",
        ),
        (
            problem(|graph, image| graph.convolution(image, point(16).groups(0))),
            "0 groups do not divide",
        ),
        (problem(|graph, image| graph.convolution(image, square().stride([1, 0, 1]))), "from 1 to"),
        (
            problem(|graph, image| graph.convolution(image, square().dilation([1, usize::MAX, 1]))),
            "from 1 to",
        ),
        (
            problem(|graph, image| graph.convolution(image, square().padding([usize::MAX; 3]))),
            "from 1 to",
        ),
        (
            problem(|graph, image| {
                let layer = Convolution::transposed_image("up", 8, [2, 2]).stride([1, 3, 2]);
                graph.convolution(image, layer)
            }),
            "not smaller than its stride",
        ),
        (
            problem(|graph, image| graph.residual(image, point(32), image)),
            "point cannot be planned: it adds 32 channels to 16",
        ),
        (
            problem(|graph, image| {
                let layer = square().stride([1, 2, 2]);
                graph.residual(image, layer, image)
            }),
            "its output of size [4, 5, 5] joins one of size [4, 9, 10]",
        ),
        (
            problem(|graph, image| {
                graph.max_pool(image, Window { padding: [0, 2, 0], ..Window::same([1, 3, 3]) })
            }),
            "at most half its kernel",
        ),
        (problem(|graph, _| graph.concatenation(&[])), "at least one part"),
        (
            problem(|graph, image| {
                let half =
                    graph.max_pool(image, Window { stride: [1, 2, 2], ..Window::same([1, 3, 3]) });
                graph.concatenation(&[image, half])
            }),
            "joins one of size",
        ),
        (
            problem(|graph, image| {
                let other = {
                    let mut other = Graph::new();
                    let mut value = other.input(1);
                    for _ in 0..9 {
                        value = other.max_pool(value, Window::same([1; 3]));
                    }
                    value
                };
                graph.concatenation(&[image, other])
            }),
            "a value that is not of this graph",
        ),
        (
            problem(|graph, image| {
                graph.input(3);
                image
            }),
            "all inputs are frames of one clip",
        ),
    ];
    for (said, expected) in cases {
        assert!(said.contains(expected), "{said:?} without {expected:?}");
    }
    let nothing = Network::parameters(&Graph::new(), 1).unwrap_err();
    assert_eq!(nothing.to_string(), "layer graph cannot be planned: it has no input");
}

#[test]
fn shapes_that_cannot_be_made_are_errors() {
    let cases: [(String, &str); 3] = [
        (
            problem(|graph, image| graph.reshape(image, [1, 9, 10], 12)),
            "it makes ([1, 9, 10], 12) of",
        ),
        (
            problem(|graph, image| graph.resize(image, [0, 3], Alignment::Edges)),
            "it has no rows or no columns",
        ),
        (
            problem(|graph, image| {
                let window = Window { extra: [0, 2, 0], ..Window::same([1, 3, 3]) };
                graph.max_pool(image, window)
            }),
            "at most half its kernel",
        ),
    ];
    for (said, expected) in cases {
        assert!(said.contains(expected), "{said:?} without {expected:?}");
    }
}

/// Sizes are checked before memory is allocated for them.
#[test]
fn sizes_beyond_all_memory_are_refused() {
    for size in
        [[1, usize::MAX, 32], [1, 1 << 40, 1 << 40], [1 << 24, 1 << 24, 1 << 24], [1, 1 << 30, 3]]
    {
        let refused = load(1).plan(size).unwrap_err();
        assert!(matches!(&refused, Error::Size { got, .. } if *got == size), "{refused}");
        assert!(refused.to_string().contains("too large"), "{refused}");
    }
    let size = [usize::MAX; 3];
    let window = Window { padding: size, ..Window::same([3, 3, 3]) };
    assert_eq!(window.output(size), None);
    assert_eq!(Window { stride: size, ..window }.transposed_output(size), None);
    assert_eq!(Window { stride: [0; 3], ..window }.output([5; 3]), None);
    assert_eq!(Window { kernel: [0; 3], ..window }.output([5; 3]), None);
}

#[test]
fn a_checkpoint_of_another_network_is_listed() {
    let mut parameters = Network::parameters(&small(), 4).unwrap();
    parameters.retain(|(name, _)| name != "b.bias");
    let error =
        Network::load(&small(), weights(parameters), [1, 8, 8], Options::default()).unwrap_err();
    assert_eq!(error.to_string(), "the checkpoint does not fit the network; missing: b.bias [32]");
}
