"""Networks beside PyTorch, TensorFlow Lite and scikit-learn; images and weights in files."""

import json
import re

import numpy as np
import pytest
from support import VISION, png

from ahqp.vision import (
    LinearSvm,
    Preprocessing,
    ResNet,
    SlowOnly,
    SlowOnlyStream,
    TensorFlowLite,
    read_depth,
    read_image,
    read_weights,
)


def golden(name):
    return json.loads((VISION / name).read_text())


def numbers(name, shape):
    """The numbers of vision-models/tests/data/networks.py."""
    state = 0xCBF29CE484222325
    for byte in name.encode():
        state = (state ^ byte) * 0x100000001B3 % 2**64
    count = np.prod(shape, dtype=int)
    with np.errstate(over="ignore"):
        bits = np.uint64(state) + np.arange(count, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    bits ^= bits >> np.uint64(31)
    return ((bits >> np.uint64(40)).astype(np.float64) / 2**23 - 1.0).reshape(shape)


def weight(name, shape):
    part = name.rsplit(".", 1)[-1]
    scale, shift = 0.1, 0.0
    if part == "weight":
        scale, shift = (np.sqrt(6.0 / np.prod(shape[1:])), 0.0) if len(shape) > 1 else (0.25, 0.75)
    elif part == "running_var":
        scale, shift = 0.5, 1.0
    return (shift + scale * numbers(name, shape)).astype(np.float32)


@pytest.fixture(scope="module")
def resnet18():
    """The state dict of torchvision's ResNet-18 with twelve classes."""
    shapes = {}

    def layer(convolution, norm, outputs, inputs, side):
        shapes[f"{convolution}.weight"] = (outputs, inputs, side, side)
        for part in ("weight", "bias", "running_mean", "running_var"):
            shapes[f"{norm}.{part}"] = (outputs,)

    layer("conv1", "bn1", 64, 3, 7)
    inputs = 64
    for stage, outputs in enumerate((64, 128, 256, 512), 1):
        for block in range(2):
            place = f"layer{stage}.{block}"
            layer(f"{place}.conv1", f"{place}.bn1", outputs, inputs, 3)
            layer(f"{place}.conv2", f"{place}.bn2", outputs, outputs, 3)
            if inputs != outputs:
                layer(f"{place}.downsample.0", f"{place}.downsample.1", outputs, inputs, 1)
            inputs = outputs
    shapes |= {"fc.weight": (12, 512), "fc.bias": (12,)}
    # PyTorch's counter, which no layer reads.
    return {name: weight(name, shape) for name, shape in shapes.items()} | {"bn1.num_batches_tracked": np.int64(7)}


def inflated(images):
    """The weights of mmaction2's SlowOnly that see each frame as the ResNet does."""
    clips = {}
    for name, values in images.items():
        if name.startswith("fc."):
            clips[name.replace("fc.", "cls_head.fc_cls.")] = values
            continue
        # conv1.weight becomes conv1.conv.weight, bn1.bias conv1.bn.bias, and the parts of a shortcut likewise.
        place = re.sub(r"(conv|bn)(\d)\.", r"conv\2.\1.", name)
        place = place.replace("downsample.0", "downsample.conv").replace("downsample.1", "downsample.bn")
        if values.ndim == 4:
            later = name.startswith(("layer3", "layer4")) and ".conv" in name
            frames = np.zeros((*values.shape[:2], 3 if later else 1, *values.shape[2:]), np.float32)
            frames[:, :, frames.shape[2] // 2] = values
            values = frames
        clips[f"backbone.{place}"] = values
    return clips


def check(scores, golden):
    assert scores.logits.shape == (1, golden["classes"]) and scores.logits.dtype == np.float32
    assert scores.logits[0] == pytest.approx(golden["logits"], abs=5e-6 * golden["largest_logit"])
    assert scores.features[0, ::16] == pytest.approx(golden["features"], abs=5e-6 * golden["largest_feature"])


def test_a_resnet_agrees_with_pytorch(resnet18):
    expected = golden("networks.json")["resnet18"]
    _, _, height, width = expected["shape"]
    images = numbers("input", expected["shape"]).astype(np.float32)
    network = ResNet(resnet18, height=height, width=width)
    scores = network.infer(images)
    check(scores, expected)
    assert network.classes == 12 and network.operations > 6e8
    softmax = np.exp(scores.logits - scores.logits.max())
    assert scores.probabilities == pytest.approx(softmax / softmax.sum(), rel=1e-5)
    # Arrays of any order and type, of another size.
    small = images[:, :, :40, :48]
    other = network.infer(np.asfortranarray(small.astype(np.float64)))
    assert np.array_equal(other.logits, network.infer(small.copy()).logits)


def test_slow_only_sees_frames_as_a_resnet_does(resnet18):
    frames = numbers("frames", (3, 3, 32, 48)).astype(np.float32)
    each = ResNet(resnet18, height=32, width=48).infer(frames)
    # The head takes the mean over frames, and is linear.
    weights, size = inflated(resnet18), {"frames": 2, "height": 32, "width": 48}
    network = SlowOnly(weights, **size)
    assert network.classes == 12 and network.operations > 1e8
    clips = np.stack([frames[:2], frames[1:]]).transpose(0, 2, 1, 3, 4)
    scores = network.infer(clips)
    for clip in (0, 1):
        for seen, expected in [(scores.logits, each.logits), (scores.features, each.features)]:
            mean = expected[clip : clip + 2].mean(0)
            assert seen[clip] == pytest.approx(mean, abs=5e-6 * float(np.abs(mean).max()))
    stream = SlowOnlyStream(weights, **size)
    stream.add(frames[2])
    first, second, third = [stream.push(frame) for frame in frames]
    assert np.array_equal(second.logits, scores.logits[:1]) and np.array_equal(third.logits, scores.logits[1:])
    mean = each.logits[[2, 0]].mean(0)
    assert first.logits[0] == pytest.approx(mean, abs=5e-6 * float(np.abs(mean).max()))
    stream.clear()
    assert stream.push(frames[0]) is None


def test_every_operator_of_tensorflow_lite():
    file = VISION / "operators.tflite"
    network = TensorFlowLite(file)
    rows, columns, channels = network.input
    image = (np.arange(rows * columns * channels) * 37 % 101 / 50.0 - 1.0).reshape(1, rows, columns, channels)
    outputs = network.infer(image)
    for output, expected, shape in zip(outputs, golden("operators.json"), network.outputs, strict=True):
        assert output.shape == (1, *shape) and output.dtype == np.float32
        assert output.ravel() == pytest.approx(expected["values"], abs=5e-6)
    # A batch, in memory, and one output of it.
    third = TensorFlowLite(file.read_bytes(), outputs=[2], threads=2)
    both = third.infer(np.concatenate([image, 0.5 * image]))[0]
    assert both.shape[0] == 2 and np.array_equal(both[0], outputs[2][0])


def test_machines_are_those_of_scikit_learn():
    for case in golden("svm.json"):
        classes = [f"class {number}" for number in range(case["classes"])]
        for machine in case["machines"]:
            svm, trainings = LinearSvm.train(
                case["points"],
                np.array(case["labels"]),
                classes,
                loss=machine["loss"],
                cost=case["cost"],
                bias_scaling=machine["scaling"],
                class_weights=case["weights"],
                tolerance=1e-11,
            )
            assert all(training.converged and training.gap <= 1e-11 for training in trainings)
            assert all(training.iterations > 0 and training.objective > 0.0 for training in trainings)
            planes = np.array(machine["planes"])
            assert svm.weights == pytest.approx(planes[:, 1:], abs=2e-5)
            assert svm.biases == pytest.approx(planes[:, 0], abs=2e-5)


def test_a_machine_in_a_file_is_the_same(tmp_path):
    case = golden("svm.json")[2]
    svm, _ = LinearSvm.train(case["points"], case["labels"], ["a", "b", "c"], class_weights="balanced")
    svm.save(tmp_path / "machine.svm")
    copy = LinearSvm.load(tmp_path / "machine.svm")
    assert copy == svm == LinearSvm(svm.classes, svm.weights, svm.biases)
    points = np.array(case["points"], np.float32)
    decisions = points.astype(float) @ svm.weights.T + svm.biases
    assert svm.decide(points) == pytest.approx(decisions, rel=1e-12)
    assert np.array_equal(svm.classify(points), decisions.argmax(1))


def frame(height, width):
    """The frame of vision-models/tests/data/preprocessing.py."""
    index = np.arange(height * width * 3, dtype=np.uint64)
    noise = ((index * 2654435761) & 0xFFFFFFFF) >> 24
    return ((noise + index // (3 * width) * 5) & 255).astype(np.uint8).reshape(height, width, 3)


def test_frames_are_converted_as_by_the_libraries():
    for case in golden("preprocessing.json")["pipelines"]:
        image = frame(*case["size"])
        for name, library, how in [
            ("torchvision", "torchvision", {"short_side": 31}),
            ("square", "torchvision", {"square": 31}),
            ("mmaction2", "mmaction2", {"short_side": 31}),
            ("pytorchvideo", "pytorchvideo", {"short_side": 31}),
        ]:
            preprocessing = Preprocessing(library, crop=24, **how)
            seen = preprocessing.image(image)
            assert seen.shape == (1, 3, 24, 24) and seen.dtype == np.float32
            assert seen.ravel()[::7] == pytest.approx(case[name], abs=3e-5)
    mirrored = frame(48, 64)[:, ::-1]
    assert np.array_equal(preprocessing.image(mirrored), preprocessing.image(mirrored.copy()))
    clip = preprocessing.clip(np.stack([image, image[::-1]]))
    assert clip.shape == (1, 3, 2, 24, 24) and np.array_equal(clip[:, :, 0], seen)
    assert Preprocessing("torchvision", short_side=255) == Preprocessing.TORCHVISION != Preprocessing.SURFACE
    assert repr(Preprocessing.MMACTION2) == 'Preprocessing("mmaction2", short_side=256, crop=256, crops="centre")'


def test_images_in_files(tmp_path):
    colour, depth = frame(5, 7), np.arange(12, dtype=np.uint16).reshape(3, 4) * 300
    (tmp_path / "colour.png").write_bytes(png(colour))
    (tmp_path / "depth.png").write_bytes(png(depth))
    assert np.array_equal(read_image(tmp_path / "colour.png"), colour)
    assert read_image(tmp_path / "colour.png", exif=True).dtype == np.uint8
    assert read_depth(tmp_path / "depth.png") == pytest.approx(depth * 0.001)
    assert read_depth(tmp_path / "depth.png", unit=0.01) == pytest.approx(depth * 0.01)


@pytest.mark.parametrize("file", ["plain.pth", "plain.safetensors", "stream.pth"])
def test_weights_are_those_that_torch_wrote(file):
    expected = golden("plain.json")
    weights = read_weights(VISION / file)
    known = set(weights) & set(expected)
    assert len(known) > 1
    for name in known:
        assert weights[name].shape == tuple(expected[name]["shape"]) and weights[name].dtype == np.float32
        values = [float(value) for value in expected[name]["values"]]
        assert weights[name].ravel() == pytest.approx(values, rel=1e-6)


def test_a_network_is_told_by_its_weights(resnet18):
    with pytest.raises(ValueError, match="they are those of ResNet-18; give those of SlowOnly"):
        SlowOnly(resnet18)
    with pytest.raises(ValueError, match="no network that is known"):
        ResNet(VISION / "plain.pth")
