//! Conversion of each operator of a file.

use crate::engine::{Activation, Alignment, Convolution, Window};
use crate::error::Error;
use crate::weights::refused;
use crate::weights::tensorflow_lite::{Operator, OptionKind};

use super::lowering::{Lowering, declared, paddings};
use super::values::{Known, Shape, Written};
use super::weights::Source;

/// The supported operators, with their numbers in `BuiltinOperator`.
const KNOWN: [(i32, &str); 15] = [
    (0, "ADD"),
    (2, "CONCATENATION"),
    (3, "CONV_2D"),
    (4, "DEPTHWISE_CONV_2D"),
    (5, "DEPTH_TO_SPACE"),
    (6, "DEQUANTIZE"),
    (14, "LOGISTIC"),
    (17, "MAX_POOL_2D"),
    (19, "RELU"),
    (21, "RELU6"),
    (22, "RESHAPE"),
    (23, "RESIZE_BILINEAR"),
    (34, "PAD"),
    (54, "PRELU"),
    (124, "DENSIFY"),
];

/// An operator that is being converted.
struct At<'a> {
    operator: Operator<'a>,
    /// The operator's name for errors and weights.
    name: String,
}

/// Adds the layers of an operator to the graph.
///
/// # Errors
/// [`Error::Checkpoint`] with the operator's number and name.
pub(super) fn operate(lowering: &mut Lowering<'_>, index: usize) -> Result<(), Error> {
    let operator = lowering.model.operator(index)?;
    let Some((code, name)) = KNOWN.into_iter().find(|(code, _)| *code == operator.code) else {
        let known = KNOWN.map(|(_, name)| name).join(", ");
        let problem =
            format!("no layer does what operator {} does: only {known} are read", operator.code);
        return Err(refused(format_args!("operator {index}"), problem));
    };
    let at = At { operator, name: format!("{index}.{name}") };
    let written = match code {
        0 => add(lowering, &at)?,
        2 => concatenate(lowering, &at)?,
        3 | 4 => convolve(lowering, &at, code == 4)?,
        5 => depth_to_space(lowering, &at)?,
        6 | 124 => {
            let source = lowering.source(at.input(0)?);
            Written::Constant(source.ok_or_else(|| at.refuse("what it decodes is computed"))?)
        }
        14 => activate(lowering, &at, Activation::Logistic)?,
        17 => max_pool(lowering, &at)?,
        19 => activate(lowering, &at, Activation::Relu)?,
        21 => activate(lowering, &at, Activation::Relu6)?,
        22 => reshape(lowering, &at)?,
        23 => resize(lowering, &at)?,
        34 => pad(lowering, &at)?,
        _ => {
            let slopes = slopes(lowering, &at)?;
            activate(lowering, &at, slopes)?
        }
    };
    lowering.write(at.output()?, written)
}

impl At<'_> {
    fn refuse(&self, problem: impl Into<String>) -> Error {
        refused(format_args!("operator {}", self.name), problem.into())
    }

    /// Returns the operand of this number.
    fn input(&self, index: usize) -> Result<usize, Error> {
        let tensor = self.operator.inputs.get(index).copied().flatten();
        tensor.ok_or_else(|| self.refuse(format!("operand {index} is missing")))
    }

    fn output(&self) -> Result<usize, Error> {
        match self.operator.outputs[..] {
            [output] => Ok(output),
            _ => Err(self.refuse(format!("it has {} outputs", self.operator.outputs.len()))),
        }
    }

    fn byte(&self, field: usize) -> Result<i32, Error> {
        self.operator.option(field, OptionKind::Byte)
    }

    fn word(&self, field: usize) -> Result<i32, Error> {
        self.operator.option(field, OptionKind::Word)
    }

    /// Returns a count that is at least one. One if it is missing.
    fn count(&self, field: usize) -> Result<usize, Error> {
        let count = self.word(field)?.max(1);
        usize::try_from(count).map_err(|_| self.refuse(format!("option {field} is {count}")))
    }

    /// Returns the function that is part of the operator.
    fn activation(&self, field: usize) -> Result<Activation, Error> {
        match self.byte(field)? {
            0 => Ok(Activation::None),
            1 => Ok(Activation::Relu),
            3 => Ok(Activation::Relu6),
            other => Err(self.refuse(format!("function {other} is neither none, RELU nor RELU6"))),
        }
    }

    /// Returns the zeros before and after an axis: enough for an output at each step, or none.
    fn zeros(&self, size: usize, [span, stride]: [usize; 2]) -> Result<[usize; 2], Error> {
        match self.byte(0)? {
            0 => {
                let outputs = size.div_ceil(stride);
                let whole = (outputs - 1).saturating_mul(stride).saturating_add(span);
                let all = whole.saturating_sub(size);
                Ok([all / 2, all - all / 2])
            }
            1 => Ok([0, 0]),
            other => Err(self.refuse(format!("padding {other} is neither SAME nor VALID"))),
        }
    }

    /// Returns the window over rows and columns of an input, whose output size is
    /// [`Window::output`].
    fn window(
        &self,
        input: Shape,
        kernel: [usize; 2],
        stride: [usize; 2],
        dilation: [usize; 2],
    ) -> Result<Window, Error> {
        let along = |axis: usize| {
            let span = (kernel[axis] - 1).saturating_mul(dilation[axis]).saturating_add(1);
            self.zeros(input.size[1 + axis], [span, stride[axis]])
        };
        let (padding, extra) = paddings([along(0)?, along(1)?]);
        let all = |[rows, columns]: [usize; 2]| [1, rows, columns];
        Ok(Window {
            kernel: all(kernel),
            stride: all(stride),
            padding,
            dilation: all(dilation),
            extra,
        })
    }

    /// Returns the size after a window.
    fn behind(&self, window: &Window, size: [usize; 3]) -> Result<[usize; 3], Error> {
        let fits = window.output(size).filter(|size| !size.contains(&0));
        fits.ok_or_else(|| self.refuse(format!("its {window:?} does not fit {size:?}")))
    }
}

/// Converts CONV_2D and DEPTHWISE_CONV_2D.
fn convolve(lowering: &mut Lowering<'_>, at: &At<'_>, depthwise: bool) -> Result<Written, Error> {
    // The options differ only in the depthwise multiplier, which the kernel's shape gives too.
    let later = usize::from(depthwise);
    let activation = at.activation(3 + later)?;
    let (stride, dilation) =
        ([at.count(2)?, at.count(1)?], [at.count(5 + later)?, at.count(4 + later)?]);
    let kernel = lowering.constant(at.input(1)?)?;
    let [first, rows, columns, last] = kernel.shape[..] else {
        return Err(at.refuse(format!("the kernel is of shape {:?}", kernel.shape)));
    };
    if kernel.shape.contains(&0) {
        return Err(at.refuse(format!("the kernel of shape {:?} is empty", kernel.shape)));
    }
    // A preceding padding becomes part of the convolution.
    let mut input = at.input(0)?;
    let mut before = [[0; 2]; 2];
    if let Some(Written::Padded { input: inner, zeros: [rows, columns, [0, 0]], .. }) =
        lowering.written(input)
        && at.byte(0)? == 1
    {
        (input, before) = (*inner, [*rows, *columns]);
    }
    let Known { value, shape } = lowering.activation(input)?;
    let mut window = at.window(shape, [rows, columns], stride, dilation)?;
    if before != [[0; 2]; 2] {
        (window.padding, window.extra) = paddings(before);
    }
    let (outputs, groups, source, order) = if depthwise {
        let per_channel = last / shape.channels;
        if first != 1 || per_channel == 0 || per_channel * shape.channels != last {
            let problem =
                format!("a kernel of {:?} over {} channels", kernel.shape, shape.channels);
            return Err(at.refuse(problem));
        }
        (last, shape.channels, Source::Depthwise(kernel), vec![last, 1, rows, columns])
    } else {
        if !shape.channels.is_multiple_of(last) {
            let problem =
                format!("a kernel of {:?} over {} channels", kernel.shape, shape.channels);
            return Err(at.refuse(problem));
        }
        (first, shape.channels / last, Source::Kernel(kernel), vec![first, last, rows, columns])
    };
    lowering.weight(format!("{}.weight", at.name), order, source)?;
    let mut layer = Convolution::image(at.name.clone(), outputs, [rows, columns])
        .stride(window.stride)
        .dilation(window.dilation)
        .padding(window.padding)
        .extra_padding(window.extra)
        .groups(groups)
        .activation(activation);
    if at.operator.inputs.get(2).is_some_and(Option::is_some) {
        bias(lowering, at, at.input(2)?, outputs)?;
        layer = layer.bias();
    }
    let shape = Shape { size: at.behind(&window, shape.size)?, channels: outputs };
    Ok(Written::Convolution { layer, input: value, shape })
}

/// Returns the bias of each output of an operator, or one for all.
fn bias(
    lowering: &mut Lowering<'_>,
    at: &At<'_>,
    tensor: usize,
    outputs: usize,
) -> Result<(), Error> {
    let constant = lowering.constant(tensor)?;
    let count = constant.elements();
    if count != 1 && (count != outputs || constant.shape.last() != Some(&outputs)) {
        return Err(at.refuse(format!("{:?} is added to {outputs} channels", constant.shape)));
    }
    lowering.weight(format!("{}.bias", at.name), vec![outputs], Source::InOrder(constant))
}

/// Converts ADD: of two activations, or of an activation and a constant for each channel.
fn add(lowering: &mut Lowering<'_>, at: &At<'_>) -> Result<Written, Error> {
    let activation = at.activation(0)?;
    let [one, other] = [at.input(0)?, at.input(1)?];
    // The constant may be the first operand.
    for [input, term] in [[one, other], [other, one]] {
        if lowering.written(term).is_none_or(|term| matches!(term, Written::Constant(_))) {
            let Known { value, shape } = lowering.activation(input)?;
            bias(lowering, at, term, shape.channels)?;
            let layer = lowering.identity(at.name.clone(), shape.channels, activation)?.bias();
            return Ok(Written::Convolution { layer, input: value, shape });
        }
    }
    let shapes = [one, other].map(|tensor| lowering.written(tensor).and_then(Written::shape));
    let [Some(shape), Some(second)] = shapes else {
        return Err(at.refuse("an operand is no activation"));
    };
    if shape != second {
        let (shape, second) = (shape.image(), second.image());
        return Err(at.refuse(format!("{shape:?} and {second:?} are added")));
    }
    // A convolution without a function can add its output to the other activation.
    for [first, second] in [[one, other], [other, one]] {
        if let Some(Written::Convolution { layer, input, .. }) = lowering.lone_convolution(first)
            && layer.is_linear()
        {
            let (layer, input) = (layer.clone().activation(activation), *input);
            let shortcut = lowering.activation(second)?.value;
            let value = lowering.graph.residual(input, layer, shortcut);
            return Ok(Written::Activation(Known { value, shape }));
        }
    }
    let layer = lowering.identity(at.name.clone(), shape.channels, activation)?;
    let [input, shortcut] = [lowering.activation(one)?.value, lowering.activation(other)?.value];
    let value = lowering.graph.residual(input, layer, shortcut);
    Ok(Written::Activation(Known { value, shape }))
}

/// Converts a function by itself. It becomes part of the preceding convolution if nothing else
/// reads that.
fn activate(
    lowering: &mut Lowering<'_>,
    at: &At<'_>,
    activation: Activation,
) -> Result<Written, Error> {
    let input = at.input(0)?;
    if let Some(Written::Convolution { layer, input, shape }) = lowering.lone_convolution(input)
        && layer.is_linear()
    {
        let (layer, input, shape) = (layer.clone().activation(activation), *input, *shape);
        return Ok(Written::Convolution { layer, input, shape });
    }
    let Known { value, shape } = lowering.activation(input)?;
    let layer = lowering.identity(at.name.clone(), shape.channels, activation)?;
    Ok(Written::Convolution { layer, input: value, shape })
}

/// Returns the slopes of PRELU: one for each channel, or one for all.
fn slopes(lowering: &mut Lowering<'_>, at: &At<'_>) -> Result<Activation, Error> {
    let input = at.input(0)?;
    let shape = lowering.written(input).and_then(Written::shape);
    let channels = shape.map(|shape| shape.channels);
    let constant = lowering.constant(at.input(1)?)?;
    let count = constant.elements();
    let shared = count == 1;
    if !shared && (Some(count) != channels || constant.shape.last().copied() != channels) {
        return Err(at.refuse(format!("slopes of shape {:?}", constant.shape)));
    }
    let name = format!("{}.slopes", at.name);
    lowering.weight(format!("{name}.weight"), vec![count], Source::InOrder(constant))?;
    Ok(Activation::Prelu { name, shared })
}

fn max_pool(lowering: &mut Lowering<'_>, at: &At<'_>) -> Result<Written, Error> {
    let activation = at.activation(5)?;
    let Known { value, shape } = lowering.activation(at.input(0)?)?;
    let (stride, kernel) = ([at.count(2)?, at.count(1)?], [at.count(4)?, at.count(3)?]);
    let window = at.window(shape, kernel, stride, [1, 1])?;
    let pooled = lowering.graph.max_pool(value, window);
    let shape = Shape { size: at.behind(&window, shape.size)?, ..shape };
    if activation == Activation::None {
        return Ok(Written::Activation(Known { value: pooled, shape }));
    }
    let layer = lowering.identity(at.name.clone(), shape.channels, activation)?;
    Ok(Written::Convolution { layer, input: pooled, shape })
}

/// Converts CONCATENATION: of channels, or of elements that are contiguous after reshaping the
/// axes.
fn concatenate(lowering: &mut Lowering<'_>, at: &At<'_>) -> Result<Written, Error> {
    if at.activation(1)? != Activation::None {
        return Err(at.refuse("a function behind a concatenation is not read"));
    }
    let rank = lowering.model.head(at.output()?)?.shape.len();
    let (axis, known) = (at.word(0)?, lowering.known(&at.operator.inputs)?);
    // The index among four axes, counted from the last.
    let from_end = if axis < 0 {
        axis.unsigned_abs() as usize
    } else {
        rank.saturating_sub(axis.unsigned_abs() as usize)
    };
    if !(1..=3).contains(&from_end) {
        return Err(
            at.refuse(format!("axis {axis} of {rank}: rows, columns or channels are joined"))
        );
    }
    let axis = 4 - from_end;
    let mut axes = known.first().map_or([0; 4], |first| first.shape.axes());
    axes[axis] = 0;
    for part in &known {
        let mut own = part.shape.axes();
        axes[axis] = axes[axis].saturating_add(own[axis]);
        own[axis] = axes[axis];
        if own != axes {
            return Err(at.refuse(format!("{:?} is joined to others of {axes:?}", part.shape)));
        }
    }
    let [frames, rows, columns, channels] = axes;
    let shape = Shape { size: [frames, rows, columns], channels };
    let graph = &mut lowering.graph;
    if axis == 3 {
        let parts: Vec<_> = known.iter().map(|part| part.value).collect();
        return Ok(Written::Activation(Known { value: graph.concatenation(&parts), shape }));
    }
    let before: usize = axes[..axis].iter().product();
    let mut flat = Vec::with_capacity(known.len());
    for part in known {
        let behind = part.shape.axes()[axis..].iter().product();
        flat.push(graph.reshape(part.value, [1, 1, before], behind));
    }
    let joined = graph.concatenation(&flat);
    let value = graph.reshape(joined, shape.size, shape.channels);
    Ok(Written::Activation(Known { value, shape }))
}

/// Converts DEPTH_TO_SPACE: each channel of the input is a pixel of a square of the output.
fn depth_to_space(lowering: &mut Lowering<'_>, at: &At<'_>) -> Result<Written, Error> {
    let side = at.count(0)?;
    let Known { value, shape } = lowering.activation(at.input(0)?)?;
    let outputs = side.checked_mul(side).and_then(|pixels| shape.channels.checked_div(pixels));
    let outputs = outputs.filter(|outputs| outputs * side * side == shape.channels && side <= 64);
    let Some(outputs) = outputs else {
        let problem = format!("squares of {side} × {side} are made of {} channels", shape.channels);
        return Err(at.refuse(problem));
    };
    let order = vec![shape.channels, outputs, side, side];
    lowering.weight(format!("{}.weight", at.name), order, Source::DepthToSpace)?;
    let layer = Convolution::transposed_image(at.name.clone(), outputs, [side, side])
        .stride([1, side, side]);
    let [frames, rows, columns] = shape.size;
    let size = [frames, rows.saturating_mul(side), columns.saturating_mul(side)];
    let shape = Shape { size, channels: outputs };
    Ok(Written::Convolution { layer, input: value, shape })
}

fn reshape(lowering: &mut Lowering<'_>, at: &At<'_>) -> Result<Written, Error> {
    let known = lowering.activation(at.input(0)?)?;
    let shape = declared(&lowering.model, at.output()?)?;
    if shape == known.shape {
        return Ok(Written::Activation(known));
    }
    if shape.elements() != known.shape.elements() {
        return Err(at.refuse(format!("{shape:?} is made of {:?}", known.shape)));
    }
    let value = lowering.graph.reshape(known.value, shape.size, shape.channels);
    Ok(Written::Activation(Known { value, shape }))
}

fn resize(lowering: &mut Lowering<'_>, at: &At<'_>) -> Result<Written, Error> {
    let alignment = match (at.byte(2)? != 0, at.byte(3)? != 0) {
        (false, false) => Alignment::FirstPixels,
        (false, true) => Alignment::Edges,
        (true, false) => Alignment::OuterPixels,
        (true, true) => return Err(at.refuse("corners and half pixels are both asked for")),
    };
    let size: [i32; 2] = lowering.constant(at.input(1)?)?.whole(&lowering.model)?;
    let Known { value, shape } = lowering.activation(at.input(0)?)?;
    let wanted = size.map(|axis| usize::try_from(axis).unwrap_or(0));
    let [rows, columns] = wanted;
    if wanted.contains(&0) {
        return Err(at.refuse(format!("{size:?} rows and columns are asked for")));
    }
    let shape = Shape { size: [shape.size[0], rows, columns], ..shape };
    let value = lowering.graph.resize(value, wanted, alignment);
    Ok(Written::Activation(Known { value, shape }))
}

/// Converts PAD with zeros. It waits for a convolution that it can become part of.
fn pad(lowering: &mut Lowering<'_>, at: &At<'_>) -> Result<Written, Error> {
    let input = at.input(0)?;
    let numbers: [i32; 8] = lowering.constant(at.input(1)?)?.whole(&lowering.model)?;
    let zero = |index: usize| usize::try_from(numbers[index]).ok().filter(|&zeros| zeros < 1 << 12);
    let pair = |index: usize| Some([zero(index)?, zero(index + 1)?]);
    let zeros = pair(0).zip(pair(2)).zip(pair(4)).zip(pair(6));
    let Some(((([0, 0], rows), columns), channels)) = zeros else {
        return Err(at.refuse(format!("zeros {numbers:?} are asked for")));
    };
    let zeros = [rows, columns, channels];
    // The input must be an activation.
    let known = lowering.activation(input)?;
    let more = |size: usize, [before, after]: [usize; 2]| size.saturating_add(before + after);
    let [frames, height, width] = known.shape.size;
    let shape = Shape {
        size: [frames, more(height, rows), more(width, columns)],
        channels: more(known.shape.channels, channels),
    };
    Ok(Written::Padded { input, zeros, shape })
}
