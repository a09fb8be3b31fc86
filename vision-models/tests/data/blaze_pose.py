"""Makes blaze_detector.tflite and blaze_landmarks.tflite: networks of BlazePose's inputs and outputs, for
tests/it/blaze_pose.rs.

Needs `pip install ai-edge-litert`. The detector finds a person where every thirty-second pixel is white; the landmarks
are the same in every region.
"""

import numpy as np
from operators import HERE, Network


def fixed(network, x, outputs, stride, bias, weights=None):
    """A convolution of 1 × 1 that reads every n-th pixel."""
    _, rows, columns, inputs = network.shape(x)
    if weights is None:
        weights = np.zeros([outputs, 1, 1, inputs])
    half = network.tensor([outputs, 1, 1, inputs], weights, "float16")
    operands = [
        x,
        network.operator("DEQUANTIZE", [half], [outputs, 1, 1, inputs]),
        network.operator("DEQUANTIZE", [network.tensor([outputs], bias, "float16")], [outputs]),
    ]
    shape = [1, rows // stride, columns // stride, outputs]
    return network.operator("CONV_2D", operands, shape, options="Conv2DOptions", padding=1, strideW=stride,
                            strideH=stride, dilationWFactor=1, dilationHFactor=1, fusedActivationFunction=0)


def detector():
    n = Network()
    image = n.tensor([1, 224, 224, 3])
    # The first of a cell's forty-six boxes has a high score if its pixel is white: -30 + 2 x 20.
    bias, weights = np.full(46, -30.0), np.zeros([46, 1, 1, 3])
    bias[0], weights[0] = 10, 20 / 3
    scores = n.reshape(fixed(n, image, 46, 32, bias, weights), [1, 2254, 1])
    box = np.zeros([46, 12])
    # Half as wide as the image. The hips are at the anchor, and the circle's edge is 56 pixels above.
    box[:, 2:4], box[:, 7] = 112, -56
    boxes = n.reshape(fixed(n, image, 552, 32, box.ravel()), [1, 2254, 12])
    n.graph.inputs, n.graph.outputs = [image], [boxes, scores]
    return n.bytes()


def landmarks():
    n = Network()
    image = n.tensor([1, 256, 256, 3])
    points = np.zeros([39, 5])
    points[:, 0], points[:, 1] = 64 + 4 * np.arange(39), 32 + 4 * np.arange(39)
    points[:, 2], points[:, 3], points[:, 4] = 16, 4, 8
    # The next region: the hips in the middle, and the circle's edge at four fifths of the height above.
    points[33, :2], points[34, :2] = [128, 128], [128, 128 - 102.4]
    metric = np.stack([np.arange(39) / 64, np.arange(39) / 32, np.ones(39)], 1)
    # The score is given by the pixel at the top left: 16 if it is white, -16 if it is black.
    ends = [
        n.reshape(fixed(n, image, 195, 256, points.ravel()), [1, 195]),
        n.operator("LOGISTIC", [fixed(n, image, 1, 256, [-16], np.full([1, 1, 1, 3], 32 / 3))], [1, 1, 1, 1]),
        fixed(n, image, 1, 1, [0]),
        fixed(n, image, 39, 4, np.full(39, -10)),
        n.reshape(fixed(n, image, 117, 256, metric.ravel()), [1, 117]),
    ]
    ends[1] = n.reshape(ends[1], [1, 1])
    n.graph.inputs, n.graph.outputs = [image], ends
    return n.bytes()


if __name__ == "__main__":
    (HERE / "blaze_detector.tflite").write_bytes(detector())
    (HERE / "blaze_landmarks.tflite").write_bytes(landmarks())
