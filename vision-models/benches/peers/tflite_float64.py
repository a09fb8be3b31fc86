"""Runs a network of TensorFlow Lite in float64: the truth that float32 kernels are held against."""

from pathlib import Path

import numpy as np
from ai_edge_litert import schema_py_generated as schema

NAMES = {number: name for name, number in vars(schema.BuiltinOperator).items() if isinstance(number, int)}
ELEMENTS = {0: np.float32, 1: np.float16, 2: np.int32}
RELU, RELU6 = 1, 3
VALID = 1


class Network:
    """The operators of BlazePose, one image at a time."""

    def __init__(self, path):
        model = schema.ModelT.InitFromObj(schema.Model.GetRootAs(Path(path).read_bytes(), 0))
        self.graph = model.subgraphs[0]
        codes = [max(code.builtinCode, code.deprecatedBuiltinCode) for code in model.operatorCodes]
        self.names = [NAMES[codes[operator.opcodeIndex]] for operator in self.graph.operators]
        self.constants = {}
        for index, tensor in enumerate(self.graph.tensors):
            data = model.buffers[tensor.buffer].data
            if tensor.buffer == 0 or data is None or len(data) == 0:
                continue
            values = np.frombuffer(bytes(data), ELEMENTS[tensor.type])
            values = values.astype(float) if tensor.type != 2 else values
            self.constants[index] = values.reshape(tensor.shape) if tensor.sparsity is None else dense(tensor, values)

    def run(self, image):
        """The outputs for an image, rows x columns x 3."""
        values = {**self.constants, self.graph.inputs[0]: image.astype(float)[None]}
        for name, operator in zip(self.names, self.graph.operators):
            inputs = [values.get(index) for index in operator.inputs]
            values[operator.outputs[0]] = self.compute(name, operator, inputs)
        return [values[index][0] for index in self.graph.outputs]

    def compute(self, name, operator, inputs):
        first, options = inputs[0], operator.builtinOptions
        match name:
            case "DEQUANTIZE" | "DENSIFY":
                return first
            case "CONV_2D" | "DEPTHWISE_CONV_2D":
                return finished(convolved(*inputs[:2], options, name != "CONV_2D") + inputs[2], options)
            case "ADD":
                return finished(first + inputs[1], options)
            case "MAX_POOL_2D":
                size = options.filterHeight, options.filterWidth
                return np.max([part for _, _, part in windows(first, size, options, -np.inf)], 0)
            case "PAD":
                return np.pad(first, inputs[1])
            case "RESHAPE":
                return first.reshape(self.graph.tensors[operator.outputs[0]].shape)
            case "CONCATENATION":
                return np.concatenate(inputs, options.axis)
            case "LOGISTIC":
                return 1 / (1 + np.exp(-first))
            case "PRELU":
                return np.where(first < 0, first * inputs[1], first)
            case "RESIZE_BILINEAR":
                return resized(resized(first, 1, inputs[1][0], options), 2, inputs[1][1], options)
            case "DEPTH_TO_SPACE":
                side = options.blockSize
                one, rows, columns, channels = first.shape
                parts = first.reshape(one, rows, columns, side, side, channels // side**2).transpose(0, 1, 3, 2, 4, 5)
                return parts.reshape(one, rows * side, columns * side, -1)
        raise ValueError(f"{name} is not computed here")


def finished(sums, options):
    function = options.fusedActivationFunction
    return np.clip(sums, 0, 6) if function == RELU6 else np.maximum(sums, 0) if function == RELU else sums


def windows(image, size, options, outside=0.0, dilation=(1, 1)):
    """Row and column of each tap, and what all outputs read there."""
    strides = options.strideH, options.strideW
    spans = [(taps - 1) * apart + 1 for taps, apart in zip(size, dilation)]
    if options.padding != VALID:
        more = [max((-(-length // stride) - 1) * stride + span - length, 0)
                for length, stride, span in zip(image.shape[1:3], strides, spans)]
        around = ((0, 0), *((all // 2, all - all // 2) for all in more), (0, 0))
        image = np.pad(image, around, constant_values=outside)
    counts = [(length - span) // stride + 1 for length, stride, span in zip(image.shape[1:3], strides, spans)]
    for row in range(size[0]):
        for column in range(size[1]):
            rows, columns = (slice(tap * apart, tap * apart + (count - 1) * stride + 1, stride)
                             for tap, apart, count, stride in zip((row, column), dilation, counts, strides))
            yield row, column, image[:, rows, columns]


def convolved(image, kernel, options, depthwise):
    dilation = options.dilationHFactor, options.dilationWFactor
    parts = windows(image, kernel.shape[1:3], options, 0.0, dilation)
    if depthwise:
        return sum(part * kernel[0, row, column] for row, column, part in parts)
    return sum(part @ kernel[:, row, column].T for row, column, part in parts)


def resized(image, axis, count, options):
    """Rows or columns, interpolated linearly."""
    length, places = image.shape[axis], np.arange(count, dtype=float)
    if options.alignCorners:
        places *= (length - 1) / (count - 1)
    elif options.halfPixelCenters:
        places = np.maximum((places + 0.5) * length / count - 0.5, 0)
    else:
        places *= length / count
    first = np.minimum(places.astype(int), length - 1)
    share = (places - first).reshape(-1, *[1] * (3 - axis))
    low, high = (np.take(image, np.minimum(index, length - 1), axis) for index in (first, first + 1))
    return low + share * (high - low)


def dense(tensor, values):
    """A tensor of which the file holds the elements that are not zero."""
    sparsity, filled, left = tensor.sparsity, np.zeros(tensor.shape), iter(values)

    def walk(level, entry, place):
        if level == len(sparsity.traversalOrder):
            filled[tuple(place)] = next(left)
            return
        axis, held = sparsity.traversalOrder[level], sparsity.dimMetadata[level]
        if held.format == 0:
            entries = [(entry * held.denseSize + index, index) for index in range(held.denseSize)]
        else:
            starts = held.arraySegments.values
            entries = [(at, held.arrayIndices.values[at]) for at in range(starts[entry], starts[entry + 1])]
        for entry, index in entries:
            place[axis] = index
            walk(level + 1, entry, place)

    walk(0, 0, [0] * len(tensor.shape))
    return filled
