"""Maps of the pose networks by PyTorch 2, and an affine map by OpenCV, for tests/it/pose.rs.

pip install torch torchvision opencv-python-headless
python pose.py > pose.json

Weights and inputs are the numbers of tests/it/support.rs, so that no file of weights is needed. Of each map's
values every seventh is kept, of the affine map's every fifth row and column.
"""

import json
import sys

import cv2
import numpy as np
import torch
import torchvision
from torch import nn


def numbers(name, shape):
    state = 0xCBF29CE484222325
    for byte in name.encode():
        state = (state ^ byte) * 0x100000001B3 % 2**64
    with np.errstate(over="ignore"):
        bits = np.uint64(state) + np.arange(np.prod(shape, dtype=int), dtype=np.uint64) * np.uint64(
            0x9E3779B97F4A7C15
        )
        bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    bits ^= bits >> np.uint64(31)
    return ((bits >> np.uint64(40)).astype(np.float64) / 2**23 - 1.0).reshape(shape)


def fill(model):
    for name, tensor in model.state_dict().items():
        part = name.rsplit(".", 1)[-1]
        if part == "num_batches_tracked":
            continue
        if part == "weight" and tensor.dim() > 1:
            scale, shift = np.sqrt(6.0 / np.prod(tensor.shape[1:])), 0.0
        elif part == "weight":
            scale, shift = 0.25, 0.75
        elif part == "running_var":
            scale, shift = 0.5, 1.0
        else:
            scale, shift = 0.1, 0.0
        values = shift + scale * numbers(name, tuple(tensor.shape))
        tensor.copy_(torch.from_numpy(values.astype(np.float32)))
    return model.eval()


class SimpleBaseline(nn.Module):
    """Xiao, Wu and Wei 2018, with Microsoft's names."""

    def __init__(self):
        super().__init__()
        backbone = torchvision.models.resnet50(weights=None)
        for name in ("conv1", "bn1", "layer1", "layer2", "layer3", "layer4"):
            setattr(self, name, getattr(backbone, name))
        layers = []
        for inputs in (2048, 256, 256):
            layers += [
                nn.ConvTranspose2d(inputs, 256, 4, stride=2, padding=1, bias=False),
                nn.BatchNorm2d(256),
                nn.ReLU(),
            ]
        self.deconv_layers = nn.Sequential(*layers)
        self.final_layer = nn.Conv2d(256, 17, 1)

    def forward(self, x):
        x = nn.functional.max_pool2d(torch.relu(self.bn1(self.conv1(x))), 3, 2, 1)
        x = self.layer4(self.layer3(self.layer2(self.layer1(x))))
        return [self.final_layer(self.deconv_layers(x))]


class OpenPose(nn.Module):
    """Cao, Simon, Wei and Sheikh 2017, with the Caffe model's names."""

    FRONT = (
        ("conv1_1", 64), ("conv1_2", 64), None, ("conv2_1", 128), ("conv2_2", 128), None,
        ("conv3_1", 256), ("conv3_2", 256), ("conv3_3", 256), ("conv3_4", 256), None,
        ("conv4_1", 512), ("conv4_2", 512), ("conv4_3_CPM", 256), ("conv4_4_CPM", 128),
    )  # fmt: skip

    def __init__(self):
        super().__init__()
        inputs = 3
        for layer in filter(None, self.FRONT):
            inputs = self.add(layer[0], inputs, layer[1], 3)
        for branch, maps in ((1, 38), (2, 19)):
            for number, sizes in enumerate(((128, 128, 3), (128, 128, 3), (128, 128, 3), (128, 512, 1), (512, maps, 1))):
                self.add(f"conv5_{number + 1}_CPM_L{branch}", *sizes)
            for stage in range(2, 7):
                sizes = [(185, 128, 7)] + [(128, 128, 7)] * 4 + [(128, 128, 1), (128, maps, 1)]
                for number, size in enumerate(sizes):
                    self.add(f"Mconv{number + 1}_stage{stage}_L{branch}", *size)

    def add(self, name, inputs, outputs, side):
        setattr(self, name, nn.Conv2d(inputs, outputs, side, padding=side // 2))
        return outputs

    def chain(self, x, names):
        for name in names[:-1]:
            x = torch.relu(getattr(self, name)(x))
        return getattr(self, names[-1])(x)

    def forward(self, x):
        for layer in self.FRONT:
            x = torch.relu(getattr(self, layer[0])(x)) if layer else nn.functional.max_pool2d(x, 2)
        features = x
        for stage in range(1, 7):
            name = "conv5_{}_CPM_L{}" if stage == 1 else f"Mconv{{}}_stage{stage}_L{{}}"
            count = 5 if stage == 1 else 7
            maps = [
                self.chain(x, [name.format(number, branch) for number in range(1, count + 1)])
                for branch in (1, 2)
            ]
            x = torch.cat([*maps, features], 1)
        return maps


def golden(model, shape):
    with torch.no_grad():
        maps = fill(model)(torch.from_numpy(numbers("input", shape).astype(np.float32)))
    return {
        "shape": shape,
        "maps": [
            {
                "shape": list(map.shape),
                "largest": float(map.abs().max()),
                "values": [float(value) for value in map.flatten()[::7]],
            }
            for map in maps
        ],
    }


def affine():
    """Microsoft's get_affine_transform for a box, and OpenCV's result for a smooth image."""
    rows, columns = np.mgrid[0:120, 0:160]
    image = np.stack(
        [127.5 + 120 * np.sin(rows / 17 + colour) * np.cos(columns / 23 - colour) for colour in range(3)],
        2,
    ).round().astype(np.uint8)
    left, top, width, height = 50.0, 20.0, 45.0, 90.0
    centre = np.float32([left + width / 2, top + height / 2])
    width = max(width, height * 192 / 256) * 1.25
    source = np.float32([centre, centre + [0, -width / 2], centre + [-width / 2, -width / 2]])
    target = np.float32([[96, 128], [96, 128 - 96], [96 - 96, 128 - 96]])
    matrix = cv2.getAffineTransform(source, target)
    warped = cv2.warpAffine(image, matrix, (192, 256), flags=cv2.INTER_LINEAR)
    return warped[::5, ::5].flatten().tolist()


def main():
    result = {
        "simple_baseline": golden(SimpleBaseline(), (1, 3, 64, 96)),
        "open_pose": golden(OpenPose(), (1, 3, 40, 48)),
        "affine": affine(),
    }
    json.dump(result, sys.stdout)


main()
