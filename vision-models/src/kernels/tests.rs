//! Every kernel, on every instruction set of this machine, against the plain definition.

use proptest::prelude::*;

use super::{
    Direct, Epilogue, InstructionSet, MaxPool, Panels, Pool, Tiling, Window, Winograd, pack,
};
use crate::layout::{Extent, Layout, offset, position};

/// A convolution of random numbers.
#[derive(Clone, Debug)]
struct Case {
    window: Window,
    size: Extent,
    inputs: usize,
    outputs: usize,
    /// Channels of the layouts that are not used.
    spare: usize,
    epilogue: Epilogue,
    lanes: usize,
    seed: u64,
}

/// Numbers in [−1, 1).
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

fn axis(kernel: usize, stride: usize, padding: usize) -> impl Strategy<Value = [usize; 3]> {
    (1..=kernel, 1..=stride, 0..=padding)
        .prop_map(|(kernel, stride, padding)| [kernel, stride, padding.min(kernel / 2)])
}

fn epilogue() -> impl Strategy<Value = Epilogue> {
    (any::<bool>(), any::<bool>()).prop_map(|(add, relu)| Epilogue { add, relu })
}

fn direct_cases() -> impl Strategy<Value = Case> {
    let axes = (axis(3, 2, 1), axis(7, 3, 3), axis(7, 3, 3));
    let channels = (1..40_usize, 1..100_usize, 0..3_usize);
    let size = [3..5_usize, 7..12, 7..13];
    (axes, channels, size, epilogue(), 1..4_usize, any::<u64>()).prop_map(
        |((t, y, x), (inputs, outputs, spare), size, epilogue, lanes, seed)| {
            let part = |part: usize| [t[part], y[part], x[part]];
            let window = Window { kernel: part(0), stride: part(1), padding: part(2) };
            Case { window, size, inputs, outputs, spare, epilogue, lanes, seed }
        },
    )
}

fn winograd_cases() -> impl Strategy<Value = (Tiling, Case)> {
    let tiling = prop_oneof![Just(Tiling::Two), Just(Tiling::Four), Just(Tiling::FourFrames)];
    let channels = (1..4_usize, 1..10_usize, 0..20_usize);
    let size = [1..10_usize, 1..14, 1..14];
    (tiling, channels, size, epilogue(), 1..4_usize, any::<u64>()).prop_map(
        |(tiling, (inputs, outputs, spare), size, epilogue, lanes, seed)| {
            let kernel = tiling.kernel();
            let padding = kernel.map(|taps| taps / 2);
            let window = Window { kernel, stride: [1; 3], padding };
            let (inputs, outputs) = (16 * inputs, 16 * outputs);
            (tiling, Case { window, size, inputs, outputs, spare, epilogue, lanes, seed })
        },
    )
}

/// An activation with numbers inside its border.
fn activation(layout: &Layout, numbers: &mut Numbers) -> Vec<f32> {
    let mut memory = vec![0.0; layout.length()];
    for pixel in 0..layout.pixels() {
        let start = layout.origin() + offset(position(pixel, layout.size), layout.strides());
        memory[start..start + layout.channels].copy_from_slice(&numbers.take(layout.channels));
    }
    memory
}

/// The window's pixels around an output, each with the number of its tap.
fn taps(window: Window, size: Extent, at: Extent) -> impl Iterator<Item = (usize, Extent)> {
    (0..window.kernel.iter().product()).filter_map(move |tap| {
        let tap_at = position(tap, window.kernel);
        let mut from = [0; 3];
        for axis in 0..3 {
            from[axis] = (at[axis] * window.stride[axis] + tap_at[axis])
                .checked_sub(window.padding[axis])?;
        }
        (0..3).all(|axis| from[axis] < size[axis]).then_some((tap, from))
    })
}

/// A case's numbers, and its result in f64 by the definition of convolution.
///
/// Summed in single precision in any order, terms `t₁ … tₖ` of random signs pass sums of about
/// ‖t‖ and round each of them by at most ε/2, ε = 2⁻²³: the errors' root mean square stays below
/// `ε/2 √k ‖t‖` (Higham and Mary, A New Approach to Probabilistic Rounding Error Analysis, 2019).
struct Operands {
    input: Vec<f32>,
    from: Layout,
    to: Layout,
    kernel: Vec<f32>,
    bias: Vec<f32>,
    output: Vec<f32>,
    expected: Vec<f64>,
    /// The bound above for each number of `expected`; 0 where nothing is to be written.
    rounding: Vec<f64>,
}

impl Operands {
    fn new(case: &Case, after: Extent) -> Option<Self> {
        let Case { window, size, inputs, outputs, spare, epilogue, .. } = *case;
        let mut numbers = Numbers(case.seed);
        let mut from = Layout::dense(size, inputs + spare);
        from.widen(window.padding, after);
        let mut to = Layout::dense(window.output(size)?, outputs + 2 * spare);
        to.widen([0, 1, 2], [1, 0, 1]);
        let count: usize = window.kernel.iter().product();
        let input = activation(&from, &mut numbers);
        let output = activation(&to, &mut numbers);
        let kernel = numbers.take(outputs * inputs * count);
        let bias = numbers.take(outputs);
        let mut expected: Vec<f64> = output.iter().map(|&value| f64::from(value)).collect();
        let mut rounding = vec![0.0; expected.len()];
        for pixel in 0..to.pixels() {
            let at = position(pixel, to.size);
            for channel in 0..outputs {
                let target = to.origin() + offset(at, to.strides()) + spare + channel;
                let (mut terms, mut sum, mut squares) = (0_u32, 0.0, 0.0);
                let mut add = |term: f64| {
                    terms += 1;
                    sum += term;
                    squares += term * term;
                };
                add(f64::from(bias[channel]));
                if epilogue.add {
                    add(expected[target]);
                }
                for (tap, at) in taps(window, size, at) {
                    let start = from.origin() + offset(at, from.strides());
                    for value in 0..inputs {
                        let weight = kernel[(channel * inputs + value) * count + tap];
                        add(f64::from(input[start + value]) * f64::from(weight));
                    }
                }
                expected[target] = if epilogue.relu { sum.max(0.0) } else { sum };
                rounding[target] =
                    0.5 * f64::from(f32::EPSILON) * (f64::from(terms) * squares).sqrt();
            }
        }
        Some(Self { input, from, to, kernel, bias, output, expected, rounding })
    }

    fn bias(&self, panels: Panels) -> Vec<f32> {
        let mut bias = self.bias.clone();
        bias.resize(panels.padded(), 0.0);
        bias
    }

    /// Nothing else was written, and the results are right to `times` what rounding explains.
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
    Pool::new(lanes).map_err(|error| TestCaseError::fail(error.to_string()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn direct_convolution_is_the_definition(case in direct_cases()) {
        let Some(operands) = Operands::new(&case, case.window.padding) else { return Ok(()) };
        let count: usize = case.window.kernel.iter().product();
        let mut pool = pool(case.lanes)?;
        for isa in InstructionSet::available() {
            let panels = Panels::new(isa, case.outputs);
            let weights = pack(panels, count * case.inputs, |output, column| {
                for input in 0..case.inputs {
                    for tap in 0..count {
                        column[tap * case.inputs + input] =
                            operands.kernel[(output * case.inputs + input) * count + tap];
                    }
                }
            });
            let (from, to) = ((operands.from, case.inputs), (operands.to, case.spare));
            let plan = Direct::new(isa, panels, case.window, from, to);
            let mut output = operands.output.clone();
            let bias = operands.bias(panels);
            plan.run(&mut pool, &operands.input, &weights, &bias, &mut output, case.epilogue);
            // The worst of 6,400 cases: 4.7.
            operands.check(&output, 16.0)?;
        }
    }

    #[test]
    fn winograd_is_the_definition((tiling, case) in winograd_cases()) {
        let Some(operands) = Operands::new(&case, tiling.after(case.size)) else { return Ok(()) };
        let count: usize = case.window.kernel.iter().product();
        let mut pool = pool(case.lanes)?;
        for isa in InstructionSet::available() {
            let panels = Panels::new(isa, case.outputs);
            let weights = Winograd::pack(panels, tiling, case.inputs, |output, input, taps| {
                for (tap, value) in taps.iter_mut().enumerate() {
                    let index = (output * case.inputs + input) * count + tap;
                    *value = f64::from(operands.kernel[index]);
                }
            });
            let (from, to) = ((operands.from, case.inputs), (operands.to, case.spare));
            let plan = Winograd::new(isa, panels, tiling, from, to, case.lanes);
            let mut scratch = vec![f32::NAN; plan.scratch(case.lanes)];
            let mut output = operands.output.clone();
            let bias = operands.bias(panels);
            plan.run(
                &mut pool,
                &operands.input,
                &weights,
                &bias,
                &mut output,
                &mut scratch,
                case.epilogue,
            );
            // The worst of 6,400 cases: 57. The points of F(4×4) are up to a hundred times the
            // result, and cancel.
            operands.check(&output, 200.0)?;
        }
    }

    #[test]
    fn max_pool_is_the_definition(case in direct_cases()) {
        let Some(to) = case.window.output(case.size) else { return Ok(()) };
        let mut numbers = Numbers(case.seed);
        let from = Layout::dense(case.size, case.inputs);
        let to = Layout::dense(to, case.inputs + case.spare);
        let input: Vec<f32> = activation(&from, &mut numbers).iter().map(|v| v.abs()).collect();
        let mut pool = pool(case.lanes)?;
        for isa in InstructionSet::available() {
            let mut output = vec![7.0; to.length()];
            MaxPool::new(isa, case.window, from, to).run(&mut pool, &input, &mut output);
            for (index, &value) in output.iter().enumerate() {
                let (pixel, channel) = (index / to.channels, index % to.channels);
                let expected = if channel < case.inputs {
                    taps(case.window, case.size, position(pixel, to.size))
                        .map(|(_, at)| input[offset(at, from.strides()) + channel])
                        .fold(0.0, f32::max)
                } else {
                    7.0
                };
                prop_assert_eq!(value, expected);
            }
        }
    }

    #[test]
    fn every_task_runs_once(lanes in 1..5_usize, loops in prop::collection::vec(0..40_usize, 1..9)) {
        let mut pool = pool(lanes)?;
        for tasks in loops {
            prop_assert!(runs(&mut pool, lanes, tasks).iter().all(|&count| count == 1));
        }
    }
}

/// As many threads as are promised start, work and end.
#[test]
fn the_most_threads_run_every_task_once() {
    let lanes = crate::Options::MAX_THREADS;
    let mut pool = Pool::new(lanes).expect("so many threads");
    assert_eq!(pool.lanes(), lanes);
    assert!(runs(&mut pool, lanes, 5000).iter().all(|&count| count == 1));
}

/// How often each task of a loop runs.
fn runs(pool: &mut Pool, lanes: usize, tasks: usize) -> Vec<usize> {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let counts: Vec<AtomicUsize> = (0..tasks).map(|_| AtomicUsize::new(0)).collect();
    pool.run(tasks, &|lane, task| {
        assert!(lane < lanes);
        counts[task].fetch_add(1, Ordering::Relaxed);
    });
    counts.into_iter().map(AtomicUsize::into_inner).collect()
}
