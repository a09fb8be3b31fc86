//! Compares every kernel on every instruction set of this machine with the definition.

use proptest::prelude::*;

use super::{
    Buffer, Depthwise, Direct, Epilogue, Finish, InstructionSet, MaxPool, Operands, Panels, Pool,
    Tiling, Waiting, Window, Winograd, pack,
};
use crate::layout::{Channels, Extent, Layout, offset, position};

/// A convolution of random numbers.
#[derive(Clone, Debug)]
struct Case {
    window: Window,
    transposed: bool,
    size: Extent,
    inputs: usize,
    outputs: usize,
    groups: usize,
    /// Channels of the layouts that are not used, before the first and after the last.
    spare: usize,
    add: bool,
    /// True if products are exact, and bias and shortcut are thousands of times larger.
    large: bool,
    activation: Activation,
    lanes: usize,
    seed: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Activation {
    None,
    Relu,
    Relu6,
    Logistic,
    Prelu,
}

/// Random numbers in [−1, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        #[expect(clippy::cast_possible_truncation, reason = "the tests' numbers are f32")]
        let value = ((self.0 >> 40) as f64 / f64::from(1 << 23) - 1.0) as f32;
        value
    }

    fn take(&mut self, count: usize) -> Vec<f32> {
        (0..count).map(|_| self.next()).collect()
    }
}

fn activation() -> impl Strategy<Value = Activation> {
    prop_oneof![
        Just(Activation::None),
        Just(Activation::Relu),
        Just(Activation::Relu6),
        Just(Activation::Logistic),
        Just(Activation::Prelu)
    ]
}

prop_compose! {
    fn window()(
        kernel in [1..=3_usize, 1..=7, 1..=7],
        stride in [1..=2_usize, 1..=3, 1..=3],
        dilation in [1..=2_usize, 1..=2, 1..=3],
        padding in [0..=2_usize, 0..=3, 0..=3],
        extra in [-1..=1_isize, -1..=2, -1..=2],
    ) -> Window {
        Window { kernel, stride, padding, dilation, extra }
    }
}

prop_compose! {
    /// Generates convolutions with groups of any width.
    fn direct_cases()(
        window in window(),
        size in [3..5_usize, 7..12, 7..13],
        (groups, inputs, outputs) in prop_oneof![
            (Just(1), 1..40_usize, 1..100_usize),
            (1..9_usize, 1..6_usize, 1..40_usize),
        ],
        (spare, lanes) in (0..3_usize, 1..4_usize),
        (add, activation, seed) in (any::<bool>(), activation(), any::<u64>()),
    ) -> Case {
        let (inputs, outputs) = (groups * inputs, groups * outputs);
        let (transposed, large) = (false, false);
        Case { window, transposed, size, inputs, outputs, groups, spare, add, large, activation, lanes, seed }
    }
}

prop_compose! {
    fn transposed_cases()(
        case in direct_cases(),
        size in [1..3_usize, 1..6, 1..6],
        more in [0..=2_usize, 0..=3, 0..=3],
    ) -> Case {
        let stride = case.window.stride;
        // No kernel is smaller than its stride.
        let kernel: Extent = std::array::from_fn(|axis| stride[axis] + more[axis]);
        let padding = std::array::from_fn(|axis| case.window.padding[axis].min(kernel[axis] / 2));
        let window = Window { kernel, stride, padding, dilation: [1; 3], extra: [0; 3] };
        Case { window, size, transposed: true, ..case }
    }
}

prop_compose! {
    fn depthwise_cases()(case in direct_cases(), channels in 1..70_usize) -> Case {
        Case { inputs: channels, outputs: channels, groups: channels, ..case }
    }
}

prop_compose! {
    fn winograd_cases()(
        tiling in prop_oneof![Just(Tiling::Two), Just(Tiling::Four), Just(Tiling::FourFrames)],
        case in direct_cases(),
        (inputs, outputs, spare) in (1..4_usize, 1..10_usize, 0..20_usize),
        size in [1..10_usize, 1..14, 1..14],
    ) -> (Tiling, Case) {
        let window = Window::same(tiling.kernel());
        let (inputs, outputs, groups) = (16 * inputs, 16 * outputs, 1);
        (tiling, Case { window, size, inputs, outputs, groups, spare, ..case })
    }
}

/// Returns an activation with numbers inside its border.
fn activation_memory(layout: &Layout, numbers: &mut Numbers) -> Vec<f32> {
    let mut memory = vec![0.0; layout.length()];
    for pixel in 0..layout.pixels() {
        let start = layout.origin() + offset(position(pixel, layout.size), layout.strides());
        memory[start..start + layout.channels].copy_from_slice(&numbers.take(layout.channels));
    }
    memory
}

/// Returns the pixels that a convolution or a pooling reads for an output, each with the number of
/// its tap.
fn taps(window: Window, size: Extent, at: Extent) -> impl Iterator<Item = (usize, Extent)> {
    (0..window.kernel.iter().product()).filter_map(move |tap| {
        let tap_at = position(tap, window.kernel);
        let mut from = [0; 3];
        for axis in 0..3 {
            from[axis] = (at[axis] * window.stride[axis] + tap_at[axis] * window.dilation[axis])
                .checked_sub(window.padding[axis])?;
        }
        (0..3).all(|axis| from[axis] < size[axis]).then_some((tap, from))
    })
}

/// Returns the same for a transposed convolution by trying every input with every tap.
fn transposed_taps(window: Window, size: Extent, at: Extent) -> Vec<(usize, Extent)> {
    let pairs = (0..size.iter().product::<usize>())
        .flat_map(|pixel| (0..window.kernel.iter().product()).map(move |tap| (pixel, tap)));
    let hits = pairs.map(|(pixel, tap)| (tap, position(pixel, size))).filter(|&(tap, from)| {
        let tap_at = position(tap, window.kernel);
        (0..3).all(|axis| {
            from[axis] * window.stride[axis] + tap_at[axis] == at[axis] + window.padding[axis]
        })
    });
    hits.collect()
}

/// The numbers of a case, and its result in f64 by the definition of convolution.
///
/// Bound of the rounding error: terms `t₁ … tₖ` of random signs, summed in single precision in any
/// order, have partial sums of about ‖t‖. Each is rounded by at most ε/2, ε = 2⁻²³. The errors'
/// root mean square stays below `ε/2 √k ‖t‖` (Higham and Mary, A New Approach to Probabilistic
/// Rounding Error Analysis, 2019).
struct Numeric {
    input: Vec<f32>,
    from: Channels,
    to: Channels,
    /// Outputs × inputs of a group × taps.
    kernel: Vec<f32>,
    bias: Vec<f32>,
    slopes: Vec<f32>,
    output: Vec<f32>,
    expected: Vec<f64>,
    /// The bound above for each number of `expected`, and 0 where nothing must be written.
    rounding: Vec<f64>,
}

impl Numeric {
    fn new(case: &Case, after: Extent) -> Option<Self> {
        let Case { window, transposed, size, inputs, outputs, groups, spare, .. } = *case;
        let mut numbers = Numbers(case.seed);
        let made =
            if transposed { window.transposed_output(size)? } else { window.output(size)? };
        if made.contains(&0) {
            return None;
        }
        let mut from = Layout::dense(size, inputs + 2 * spare);
        let phases = if transposed { window.phases(made) } else { vec![window.whole(made)] };
        for phase in phases {
            let [before, after] = phase.border(size);
            from.widen(before, after);
        }
        from.widen([0; 3], after);
        let mut to = Layout::dense(made, outputs + 2 * spare);
        to.widen([0, 1, 2], [1, 0, 1]);
        let count: usize = window.kernel.iter().product();
        let mut input = activation_memory(&from, &mut numbers);
        let mut output = activation_memory(&to, &mut numbers);
        let mut kernel = numbers.take(outputs * inputs / groups * count);
        let (mut bias, slopes) = (numbers.take(outputs), numbers.take(outputs));
        if case.large {
            for value in input.iter_mut().chain(&mut kernel) {
                *value = (*value * 64.0).round() / 64.0;
            }
            for value in output.iter_mut().chain(&mut bias) {
                *value = (*value * 1e4).round();
            }
        }
        let from = Channels { layout: from, first: spare, count: inputs };
        let to = Channels { layout: to, first: spare, count: outputs };
        let (expected, rounding) =
            (output.iter().map(|&value| f64::from(value)).collect(), vec![0.0; output.len()]);
        let mut all = Self { input, from, to, kernel, bias, slopes, output, expected, rounding };
        for pixel in 0..to.layout.pixels() {
            let at = position(pixel, made);
            let taps: Vec<_> = if transposed {
                transposed_taps(window, size, at)
            } else {
                taps(window, size, at).collect()
            };
            for channel in 0..outputs {
                all.expect(case, &taps, at, channel);
            }
        }
        Some(all)
    }

    /// Computes one number of the output by the definition.
    fn expect(&mut self, case: &Case, pixels: &[(usize, Extent)], at: Extent, channel: usize) {
        let Case { window, inputs, outputs, groups, .. } = *case;
        let count: usize = window.kernel.iter().product();
        let of_group = inputs / groups;
        let group = channel / (outputs / groups);
        let target = self.to.origin() + offset(at, self.to.layout.strides()) + channel;
        let (mut terms, mut sum, mut squares) = (0_u32, 0.0, 0.0);
        let mut add = |term: f64| {
            terms += 1;
            sum += term;
            squares += term * term;
        };
        add(f64::from(self.bias[channel]));
        let shortcut = if case.add { self.expected[target] } else { 0.0 };
        add(shortcut);
        for &(tap, at) in pixels {
            let start =
                self.from.origin() + offset(at, self.from.layout.strides()) + group * of_group;
            for value in 0..of_group {
                let weight = self.kernel[(channel * of_group + value) * count + tap];
                add(f64::from(self.input[start + value]) * f64::from(weight));
            }
        }
        self.expected[target] = match case.activation {
            Activation::None => sum,
            Activation::Relu => sum.max(0.0),
            Activation::Relu6 => sum.clamp(0.0, 6.0),
            Activation::Logistic => 1.0 / (1.0 + (-sum).exp()),
            Activation::Prelu => sum.max(0.0) + f64::from(self.slopes[channel]) * sum.min(0.0),
        };
        // Exact products are rounded with the bias, and once more with the shortcut.
        let unit = 0.5 * f64::from(f32::EPSILON);
        self.rounding[target] = unit
            * if case.large {
                (sum - shortcut).abs() + sum.abs()
            } else {
                (f64::from(terms) * squares).sqrt()
            };
        if case.activation == Activation::Logistic {
            // The exponential rounds too.
            self.rounding[target] += f64::from(f32::EPSILON);
        }
    }

    /// Runs a kernel whose bias and slopes are spread by `panels`.
    fn run(
        &self,
        case: &Case,
        panels: Panels,
        weights: &Buffer,
        run: impl FnOnce(Operands<'_>, &mut [f32], Epilogue<'_>),
    ) -> Vec<f32> {
        let (bias, slopes) = (panels.spread(&self.bias), panels.spread(&self.slopes));
        let finish = match case.activation {
            Activation::None => Finish::Keep,
            Activation::Relu => Finish::Relu,
            Activation::Relu6 => Finish::Relu6,
            Activation::Logistic => Finish::Logistic,
            Activation::Prelu => Finish::Prelu(&slopes),
        };
        let mut output = self.output.clone();
        let operands = Operands { input: &self.input, weights, bias: &bias };
        run(operands, &mut output, Epilogue { add: case.add, finish });
        output
    }

    /// Checks that nothing else was written, and that errors are at most `times` the bound.
    fn check(&self, output: &[f32], times: f64) -> Result<(), TestCaseError> {
        let numbers = output.iter().zip(&self.expected).zip(&self.rounding);
        for (index, ((&value, &expected), &rounding)) in numbers.enumerate() {
            let error = (f64::from(value) - expected).abs();
            prop_assert!(
                error <= times * rounding,
                "{value} instead of {expected} at {index}, {:.1} times what rounding explains",
                error / rounding
            );
        }
        Ok(())
    }
}

fn pool(lanes: usize) -> Result<Pool, TestCaseError> {
    Pool::new(lanes, &[], Waiting::Spinning).map_err(|error| TestCaseError::fail(error.to_string()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn direct_convolution_is_the_definition(case in direct_cases()) {
        let Some(numeric) = Numeric::new(&case, [0; 3]) else { return Ok(()) };
        direct(&case, &numeric, 16.0)?;
    }

    #[test]
    fn transposed_convolution_is_the_definition(case in transposed_cases()) {
        let Some(numeric) = Numeric::new(&case, [0; 3]) else { return Ok(()) };
        direct(&case, &numeric, 16.0)?;
    }

    #[test]
    fn depthwise_convolution_is_the_definition(case in depthwise_cases()) {
        let Some(numeric) = Numeric::new(&case, [0; 3]) else { return Ok(()) };
        depthwise(&case, &numeric, 16.0)?;
    }

    #[test]
    fn winograd_is_the_definition((tiling, case) in winograd_cases()) {
        let Some(numeric) = Numeric::new(&case, tiling.after(case.size)) else { return Ok(()) };
        let count: usize = case.window.kernel.iter().product();
        let mut pool = pool(case.lanes)?;
        for isa in InstructionSet::available() {
            let panels = Panels::whole(isa, case.outputs);
            let weights = Winograd::pack(panels, tiling, case.inputs, |output, input, taps| {
                for (tap, value) in taps.iter_mut().enumerate() {
                    let index = (output * case.inputs + input) * count + tap;
                    *value = f64::from(numeric.kernel[index]);
                }
            });
            let plan = Winograd::new(isa, panels, tiling, numeric.from, numeric.to, case.lanes);
            let mut scratch = vec![f32::NAN; plan.scratch(case.lanes)];
            let output = numeric.run(&case, panels, &weights, |operands, output, epilogue| {
                plan.run(&mut pool, operands, output, &mut scratch, epilogue);
            });
            // The largest ratio of 6,400 cases is 57. The points of F(4×4) are up to a hundred
            // times the result, and cancel.
            numeric.check(&output, 200.0)?;
        }
    }

    #[test]
    fn max_pool_is_the_definition(case in direct_cases()) {
        let padding: Extent =
            std::array::from_fn(|axis| case.window.padding[axis].min(case.window.kernel[axis] / 2));
        let extra = std::array::from_fn(|axis| {
            let most = case.window.kernel[axis].cast_signed() - 1 - padding[axis].cast_signed();
            case.window.extra[axis].min(most)
        });
        let window = Window { padding, dilation: [1; 3], extra, ..case.window };
        let Some(to) = window.output(case.size) else { return Ok(()) };
        let mut numbers = Numbers(case.seed);
        let from = Layout::dense(case.size, case.inputs + 2 * case.spare);
        let to = Layout::dense(to, case.inputs + 2 * case.spare);
        let channels = |layout| Channels { layout, first: case.spare, count: case.inputs };
        let input = activation_memory(&from, &mut numbers);
        let mut pool = pool(case.lanes)?;
        for isa in InstructionSet::available() {
            let mut output = vec![7.0; to.length()];
            let plan = MaxPool::new(isa, window, channels(from), channels(to));
            plan.run(&mut pool, &input, &mut output);
            for (index, &value) in output.iter().enumerate() {
                let (pixel, channel) = (index / to.channels, index % to.channels);
                let expected = if (case.spare..case.spare + case.inputs).contains(&channel) {
                    taps(window, case.size, position(pixel, to.size))
                        .map(|(_, at)| input[offset(at, from.strides()) + channel])
                        .fold(f32::NEG_INFINITY, f32::max)
                } else {
                    7.0
                };
                prop_assert_eq!(value, expected);
            }
        }
    }
}

/// Runs the matrix kernel on every instruction set, with groups. The phases of a transposed
/// convolution run one after the other.
fn direct(case: &Case, numeric: &Numeric, times: f64) -> Result<(), TestCaseError> {
    let Case { window, inputs, outputs, groups, .. } = *case;
    let count: usize = window.kernel.iter().product();
    let of_group = inputs / groups;
    let made = numeric.to.layout.size;
    let phases = if case.transposed { window.phases(made) } else { vec![window.whole(made)] };
    let mut pool = pool(case.lanes)?;
    for isa in InstructionSet::available() {
        let panels = Panels::of_groups(isa, groups, outputs / groups);
        let mut output = numeric.output.clone();
        for phase in &phases {
            let taps = phase.kernel_taps(window.kernel);
            let weights = pack(panels, taps.len() * of_group, |output, column| {
                for input in 0..of_group {
                    for (at, tap) in taps.iter().enumerate() {
                        column[at * of_group + input] =
                            numeric.kernel[(output * of_group + input) * count + tap];
                    }
                }
            });
            let plan = Direct::new(isa, panels, phase, numeric.from, numeric.to);
            let phase = numeric.run(case, panels, &weights, |operands, output, epilogue| {
                plan.run(&mut pool, operands, output, epilogue);
            });
            // Each phase writes different pixels.
            for ((output, new), old) in output.iter_mut().zip(phase).zip(&numeric.output) {
                if new.to_bits() != old.to_bits() {
                    *output = new;
                }
            }
        }
        // The largest ratio of 6,400 cases is 4.7.
        numeric.check(&output, times)?;
    }
    Ok(())
}

/// Runs the depthwise kernel on every instruction set.
fn depthwise(case: &Case, numeric: &Numeric, times: f64) -> Result<(), TestCaseError> {
    let count: usize = case.window.kernel.iter().product();
    let mut weights = Buffer::zeroed(count * case.inputs);
    for (tap, row) in weights.chunks_exact_mut(case.inputs).enumerate() {
        for (channel, weight) in row.iter_mut().enumerate() {
            *weight = numeric.kernel[channel * count + tap];
        }
    }
    let panels = Panels { groups: 1, channels: case.inputs, width: case.inputs };
    let mut pool = pool(case.lanes)?;
    for isa in InstructionSet::available() {
        let phase = case.window.whole(numeric.to.layout.size);
        let plan = Depthwise::new(isa, &phase, numeric.from, numeric.to);
        let output = numeric.run(case, panels, &weights, |operands, output, epilogue| {
            plan.run(&mut pool, operands, output, epilogue);
        });
        numeric.check(&output, times)?;
    }
    Ok(())
}

/// Each product that is added to a large bias or shortcut would lose its last digits.
#[test]
fn large_terms_are_added_last() {
    let case = |groups| Case {
        window: Window::same([1, 3, 3]),
        transposed: false,
        size: [1, 9, 10],
        inputs: 45,
        outputs: 45,
        groups,
        spare: 1,
        add: true,
        large: true,
        activation: Activation::None,
        lanes: 2,
        seed: 1,
    };
    let numeric = |case: &Case| Numeric::new(case, [0; 3]).expect("the kernel fits");
    direct(&case(1), &numeric(&case(1)), 1.0).unwrap();
    depthwise(&case(45), &numeric(&case(45)), 1.0).unwrap();
}
