//! Networks with random weights.

use std::{io::BufWriter, sync::OnceLock};

use vision_models::{
    ResNet, ResNetDepth, SimpleBaseline, SimpleBaselineForm, SlowOnly, SlowOnlyForm, Tensor,
    Tensors,
};

use super::keep;

/// The checkpoint of a ResNet-18 with seven classes.
pub(crate) fn resnet18() -> &'static str {
    static PATH: OnceLock<String> = OnceLock::new();
    PATH.get_or_init(|| write("resnet18", ResNet::parameters(ResNetDepth::Eighteen, 7)))
}

/// The checkpoint of a SlowOnly-R18 of mmaction2 with thirty classes.
pub(crate) fn slow_only_r18() -> &'static str {
    static PATH: OnceLock<String> = OnceLock::new();
    let form = SlowOnlyForm::MmAction2Depth18;
    PATH.get_or_init(|| write("slow_only_r18", SlowOnly::parameters(form, 30)))
}

/// The checkpoint of a simple baseline in Microsoft's format.
pub(crate) fn simple_baseline() -> &'static str {
    static PATH: OnceLock<String> = OnceLock::new();
    let form = SimpleBaselineForm::Microsoft;
    PATH.get_or_init(|| write("simple_baseline", SimpleBaseline::parameters(form)))
}

/// Writes a checkpoint in the folder for test files, from where it may be read at any time.
fn write(name: &str, parameters: Vec<(String, Vec<usize>)>) -> String {
    let mut random = Congruential(1);
    let mut tensors = Tensors::new();
    for (name, shape) in parameters {
        let size = shape.iter().product();
        let fan_in: usize = shape.iter().skip(1).product();
        // Activations keep about their size from layer to layer.
        let (middle, half) = match name.rsplit('.').next() {
            Some("running_var") => (1.0, 0.5),
            Some("weight") if shape.len() == 1 => (0.75, 0.25),
            Some("weight") => (0.0, (6.0 / fan_in as f32).sqrt()),
            _ => (0.0, 0.1),
        };
        let values = (0..size).map(|_| middle + half * random.next()).collect();
        tensors.insert(name, Tensor::new(shape, values).unwrap()).unwrap();
    }
    keep(&format!("{name}.safetensors"), |file| {
        tensors.write_safetensors(BufWriter::new(file)).unwrap();
    })
}

/// A linear congruential generator (D. Knuth, "The Art of Computer Programming" 2, 3.3.4). It makes ten million numbers
/// quickly, even without optimisation.
struct Congruential(u64);

impl Congruential {
    /// The next number in [−1, 1).
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
    }
}
