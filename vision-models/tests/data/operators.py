"""Makes operators.tflite, a small network of every operator that is read, operators.json with its outputs, and
broken_operators.json: networks that are refused, each with a part of the reason.

Needs `pip install ai-edge-litert` (TensorFlow Lite); the outputs are those of its reference kernels.
"""

import json
from pathlib import Path

import flatbuffers
import numpy as np
from ai_edge_litert import schema_py_generated as schema
from ai_edge_litert.interpreter import Interpreter, OpResolverType

HERE = Path(__file__).parent
RANDOM = np.random.default_rng(49)
TYPES = {np.dtype("float32"): 0, np.dtype("float16"): 1, np.dtype("int32"): 2}


class Network:
    def __init__(self):
        self.model = schema.ModelT()
        self.model.version = 3
        self.model.description = "every operator once"
        self.model.operatorCodes, self.model.buffers = [], [schema.BufferT()]
        self.graph = schema.SubGraphT()
        self.graph.tensors, self.graph.operators = [], []
        self.model.subgraphs = [self.graph]

    def tensor(self, shape, values=None, kind="float32", sparsity=None):
        tensor = schema.TensorT()
        tensor.shape, tensor.type = list(shape), TYPES[np.dtype(kind)]
        tensor.name, tensor.sparsity = f"t{len(self.graph.tensors)}", sparsity
        tensor.buffer = 0
        if values is not None:
            buffer = schema.BufferT()
            buffer.data = np.frombuffer(np.asarray(values, kind).tobytes(), np.uint8)
            self.model.buffers.append(buffer)
            tensor.buffer = len(self.model.buffers) - 1
        self.graph.tensors.append(tensor)
        return len(self.graph.tensors) - 1

    def shape(self, tensor):
        return list(self.graph.tensors[tensor].shape)

    def operator(self, name, inputs, shape, kind="float32", options=None, **fields):
        code = schema.OperatorCodeT()
        number = getattr(schema.BuiltinOperator, name)
        code.builtinCode, code.deprecatedBuiltinCode, code.version = number, min(number, 127), 1
        self.model.operatorCodes.append(code)
        operator = schema.OperatorT()
        operator.opcodeIndex = len(self.model.operatorCodes) - 1
        operator.inputs, operator.outputs = list(inputs), [self.tensor(shape, kind=kind)]
        if options:
            operator.builtinOptionsType = getattr(schema.BuiltinOptions, options)
            operator.builtinOptions = getattr(schema, options + "T")()
            for field, value in fields.items():
                setattr(operator.builtinOptions, field, value)
        self.graph.operators.append(operator)
        return operator.outputs[0]

    def weights(self, shape, how="float32"):
        values = RANDOM.normal(size=shape) / np.sqrt(np.prod(shape[1:]))
        if how == "float32":
            return self.tensor(shape, values)
        if how == "sparse":
            values[RANDOM.random(shape) < 0.6] = 0
            half = self.sparse(values.astype(np.float16))
            half = self.operator("DENSIFY", [half], shape, "float16")
        else:
            half = self.tensor(shape, values, "float16")
        return self.operator("DEQUANTIZE", [half], shape)

    def sparse(self, values):
        """The last axis as a list of the nonzero elements, as in BlazePose's detector."""
        rows = values.reshape(-1, values.shape[-1])
        axes = []
        for size in values.shape[:-1]:
            axis = schema.DimensionMetadataT()
            axis.format, axis.denseSize = 0, size
            axes.append(axis)
        last = schema.DimensionMetadataT()
        last.format = 1
        last.arraySegmentsType, last.arraySegments = 2, schema.Uint16VectorT()
        last.arrayIndicesType, last.arrayIndices = 3, schema.Uint8VectorT()
        counts = (rows != 0).sum(1)
        last.arraySegments.values = np.concatenate([[0], np.cumsum(counts)]).astype(np.uint16)
        last.arrayIndices.values = np.nonzero(rows)[1].astype(np.uint8)
        sparsity = schema.SparsityParametersT()
        sparsity.traversalOrder = list(range(values.ndim))
        sparsity.dimMetadata = axes + [last]
        return self.tensor(values.shape, rows[rows != 0], "float16", sparsity)

    def convolution(self, x, outputs, kernel, stride=1, dilation=1, same=True, activation=0, how="float32",
                    depthwise=False):
        _, rows, columns, inputs = self.shape(x)
        size = []
        for axis in (rows, columns):
            span = (kernel - 1) * dilation + 1
            size.append(-(-axis // stride) if same else (axis - span) // stride + 1)
        fields = dict(padding=0 if same else 1, strideW=stride, strideH=stride, dilationWFactor=dilation,
                      dilationHFactor=dilation, fusedActivationFunction=activation)
        if depthwise:
            shape, name, options = [1, kernel, kernel, outputs], "DEPTHWISE_CONV_2D", "DepthwiseConv2DOptions"
            fields["depthMultiplier"] = outputs // inputs
        else:
            shape, name, options = [outputs, kernel, kernel, inputs], "CONV_2D", "Conv2DOptions"
        operands = [x, self.weights(shape, how), self.tensor([outputs], RANDOM.normal(size=outputs) / 4)]
        return self.operator(name, operands, [1, *size, outputs], options=options, **fields)

    def pad(self, x, zeros):
        shape = [size + sum(ends) for size, ends in zip(self.shape(x), zeros)]
        return self.operator("PAD", [x, self.tensor([4, 2], zeros, "int32")], shape, options="PadOptions")

    def add(self, one, other, activation=0):
        return self.operator("ADD", [one, other], self.shape(one), options="AddOptions",
                             fusedActivationFunction=activation, potScaleInt16=True)

    def resize(self, x, size, **how):
        _, _, _, channels = self.shape(x)
        return self.operator("RESIZE_BILINEAR", [x, self.tensor([2], size, "int32")], [1, *size, channels],
                             options="ResizeBilinearOptions", **how)

    def reshape(self, x, shape):
        wanted = self.tensor([len(shape)], shape, "int32")
        return self.operator("RESHAPE", [x, wanted], shape, options="ReshapeOptions", newShape=list(shape))

    def join(self, parts, axis):
        shape = self.shape(parts[0])
        shape[axis] = sum(self.shape(part)[axis] for part in parts)
        return self.operator("CONCATENATION", parts, shape, options="ConcatenationOptions", axis=axis,
                             fusedActivationFunction=0)

    def bytes(self):
        builder = flatbuffers.Builder(0)
        builder.Finish(self.model.Pack(builder), file_identifier=b"TFL3")
        return bytes(builder.Output())


def network():
    n = Network()
    image = n.tensor([1, 13, 18, 3])
    padded = n.pad(image, [[0, 0], [1, 1], [1, 2], [0, 0]])
    x = n.convolution(padded, 8, 3, stride=2, same=False, activation=3, how="float16")
    stem = n.convolution(x, 8, 3, activation=1, depthwise=True)
    x = n.convolution(stem, 16, 1, how="sparse")
    x = n.operator("PRELU", [x, n.tensor([1, 1, 16], RANDOM.normal(size=16) / 4)], n.shape(x))
    y = n.convolution(n.convolution(x, 16, 3, dilation=2), 16, 1)
    x = n.add(y, x, activation=3)
    x = n.add(n.convolution(x, 16, 3, activation=1), x)
    half = n.convolution(x, 32, 5, stride=2, depthwise=True)
    pooled = n.operator("MAX_POOL_2D", [x], [1, 4, 5, 16], options="Pool2DOptions", padding=0, strideW=2, strideH=2,
                        filterWidth=2, filterHeight=2, fusedActivationFunction=0)
    half = n.add(half, n.pad(pooled, [[0, 0], [0, 0], [0, 0], [10, 6]]), activation=1)
    half = n.add(half, n.tensor([32], RANDOM.normal(size=32)))
    half = n.operator("RELU6", [n.operator("RELU", [half], n.shape(half))], n.shape(half))
    up = [
        n.resize(half, [7, 10], halfPixelCenters=True),
        n.resize(half, [7, 10], alignCorners=True),
        n.resize(half, [7, 10]),
    ]
    up = n.join([*up, x], 3)
    spread = n.operator("DEPTH_TO_SPACE", [half], [1, 8, 10, 8], options="DepthToSpaceOptions", blockSize=2)
    spread = n.pad(spread, [[0, 0], [2, 0], [0, 1], [0, 0]])
    maps = n.operator("LOGISTIC", [spread], n.shape(spread))
    ends = [n.reshape(n.convolution(end, 4, 1), [1, -1, 2]) for end in (half, up)]
    for end, count in zip(ends, (40, 140)):
        n.graph.tensors[end].shape = [1, count, 2]
    scores = n.join(ends, 1)
    n.graph.inputs = [image]
    n.graph.outputs = [scores, maps, n.join([stem, x], -1)]
    return n.bytes()


def one_convolution(change):
    """A network of one convolution, changed."""
    n = Network()
    image = n.tensor([1, 4, 4, 2])
    n.graph.inputs, n.graph.outputs = [image], [n.convolution(image, 3, 3)]
    change(n, n.graph.operators[-1])
    return n.bytes()


def broken():
    def unknown(n, operator):
        n.model.operatorCodes[-1].builtinCode = n.model.operatorCodes[-1].deprecatedBuiltinCode = 18

    def quantised(n, operator):
        n.graph.tensors[operator.outputs[0]].type = 9

    def batch(n, operator):
        n.graph.tensors[0].shape = [2, 4, 4, 2]

    def other_size(n, operator):
        n.graph.tensors[operator.outputs[0]].shape = [1, 4, 5, 3]

    def too_few_weights(n, operator):
        n.model.buffers[1].data = n.model.buffers[1].data[:-4]

    def computed_weights(n, operator):
        n.graph.tensors[operator.inputs[1]].buffer = 0

    def other_channels(n, operator):
        n.graph.tensors[operator.inputs[1]].shape = [2, 3, 3, 3]

    def no_such_tensor(n, operator):
        operator.inputs[1] = 99

    def no_such_buffer(n, operator):
        n.graph.tensors[operator.inputs[1]].buffer = 77

    def no_such_code(n, operator):
        operator.opcodeIndex = 5

    def own_output(n, operator):
        operator.inputs[0] = operator.outputs[0]

    def twice(n, operator):
        n.graph.operators.append(operator)

    def two_inputs(n, operator):
        n.graph.inputs = [0, n.tensor([1, 4, 4, 2])]

    def two_graphs(n, operator):
        n.model.subgraphs.append(n.graph)

    def function(n, operator):
        operator.builtinOptions.fusedActivationFunction = 4

    def padding(n, operator):
        operator.builtinOptions.padding = 2

    def stride(n, operator):
        operator.builtinOptions.strideH = 1 << 30

    def dilation(n, operator):
        operator.builtinOptions.dilationHFactor = 1 << 30

    def negative(n, operator):
        n.graph.tensors[0].shape = [1, -4, 4, 2]

    def huge(n, operator):
        for tensor in (0, operator.outputs[0]):
            n.graph.tensors[tensor].shape[1:3] = [1 << 30, 1 << 30]

    def nothing(n, operator):
        n.graph.outputs = []

    def sparse(change):
        def changed(n, operator):
            values = np.zeros([3, 3, 3, 2], np.float16)
            values[:, :, 1, 1] = 1
            source = n.sparse(values)
            axes = n.graph.tensors[source].sparsity.dimMetadata
            change(n.graph.tensors[source].sparsity, axes)
            operator.inputs[1] = n.operator("DEQUANTIZE", [n.operator("DENSIFY", [source], values.shape, "float16")],
                                            values.shape)
            n.graph.operators.insert(0, n.graph.operators.pop())
            n.graph.operators.insert(0, n.graph.operators.pop())
        return changed

    def beyond(sparsity, axes):
        axes[-1].arrayIndices.values[0] = 2

    def long_segment(sparsity, axes):
        axes[-1].arraySegments.values[1:] = 60000

    def other_axis(sparsity, axes):
        axes[0].denseSize = 1 << 30

    def order(sparsity, axes):
        sparsity.traversalOrder = [0, 1, 1, 3]

    def blocks(sparsity, axes):
        sparsity.blockMap = [0]

    cases = [
        (unknown, "operator 0: no layer does what operator 18 does"),
        (quantised, "elements of type 9"),
        (batch, "shape [2, 4, 4, 2]"),
        (other_size, "comes out as [3, 4, 4], and is said to be [3, 4, 5]"),
        (too_few_weights, "shape [3, 3, 3, 2] and 212 bytes"),
        (computed_weights, "where the file has to hold it"),
        (other_channels, "a kernel of [2, 3, 3, 3] over 2 channels"),
        (no_such_tensor, "tensor 99"),
        (no_such_buffer, "buffer 77"),
        (no_such_code, "operator code 5"),
        (own_output, "no operator before has computed it"),
        (twice, "it is written twice"),
        (two_inputs, "networks of one input are read"),
        (two_graphs, "only one is read"),
        (function, "function 4 is neither none, RELU nor RELU6"),
        (padding, "padding 2 is neither SAME nor VALID"),
        (stride, "comes out as [3, 1, 4]"),
        (dilation, "kernel, stride and dilation are from 1 to 4096"),
        (negative, "an axis of -4"),
        (huge, "the activations up to here"),
        (nothing, "from 1 to 64 are read"),
        (sparse(beyond), "index 0 of a sparse axis"),
        (sparse(long_segment), "index 9 of a sparse axis"),
        (sparse(other_axis), "where there are 3"),
        (sparse(order), "traversed twice"),
        (sparse(blocks), "sparse in blocks"),
    ]
    return [[reason, one_convolution(change).hex()] for change, reason in cases]


def main():
    cases = ",\n".join(json.dumps(case) for case in broken())
    (HERE / "broken_operators.json").write_text(f"[\n{cases}\n]\n")
    file = network()
    (HERE / "operators.tflite").write_bytes(file)
    runner = Interpreter(model_content=file, experimental_op_resolver_type=OpResolverType.BUILTIN_REF)
    runner.allocate_tensors()
    (given,) = runner.get_input_details()
    count = int(np.prod(given["shape"]))
    image = ((np.arange(count) * 37 % 101) / 50 - 1).astype(np.float32).reshape(given["shape"])
    runner.set_tensor(given["index"], image)
    runner.invoke()
    outputs = [runner.get_tensor(output["index"]) for output in runner.get_output_details()]
    golden = [{"shape": list(o.shape), "values": [float(f"{v:.7g}") for v in o.ravel()]} for o in outputs]
    (HERE / "operators.json").write_text(json.dumps(golden) + "\n")
    print([(o.shape, float(np.abs(o).max())) for o in outputs], len(file), "bytes")


if __name__ == "__main__":
    main()
