"""Writes networks with random weights twice, for us (safetensors) and for the others (ONNX), with
an input and PyTorch's scores of it.

python export.py FOLDER [MODEL …]
"""

import sys
from pathlib import Path

import numpy as np
import torch
import torchvision
from safetensors.torch import save_file
from torch import nn

MODELS = ("resnet50", "resnet152", "slowonly_mm", "simple_baseline")


class ConvNorm(nn.Module):
    """A convolution and its batch norm, named as in mmaction2."""

    def __init__(self, inputs, outputs, kernel, stride=1, relu=True):
        super().__init__()
        self.conv = nn.Conv3d(
            inputs, outputs, kernel, (1, stride, stride), [taps // 2 for taps in kernel], bias=False
        )
        self.bn = nn.BatchNorm3d(outputs)
        self.relu = relu

    def forward(self, x):
        x = self.bn(self.conv(x))
        return torch.relu(x) if self.relu else x


class Bottleneck(nn.Module):
    def __init__(self, inputs, width, frames, stride):
        super().__init__()
        self.conv1 = ConvNorm(inputs, width, (frames, 1, 1))
        self.conv2 = ConvNorm(width, width, (1, 3, 3), stride)
        self.conv3 = ConvNorm(width, 4 * width, (1, 1, 1), relu=False)
        if inputs != 4 * width or stride > 1:
            self.downsample = ConvNorm(inputs, 4 * width, (1, 1, 1), stride, relu=False)

    def forward(self, x):
        shortcut = self.downsample(x) if hasattr(self, "downsample") else x
        return torch.relu(self.conv3(self.conv2(self.conv1(x))) + shortcut)


class SlowOnly(nn.Module):
    """SlowOnly-R50, with mmaction2's names."""

    def __init__(self, classes=30):
        super().__init__()
        self.backbone = nn.Module()
        self.backbone.conv1 = ConvNorm(3, 64, (1, 7, 7), 2)
        inputs = 64
        for stage, (blocks, frames) in enumerate(zip((3, 4, 6, 3), (1, 1, 3, 3))):
            width = 64 << stage
            layers = []
            for block in range(blocks):
                stride = 2 if stage and not block else 1
                layers.append(Bottleneck(inputs, width, frames, stride))
                inputs = 4 * width
            setattr(self.backbone, f"layer{stage + 1}", nn.Sequential(*layers))
        self.cls_head = nn.Module()
        self.cls_head.fc_cls = nn.Linear(inputs, classes)

    def forward(self, x):
        x = nn.functional.max_pool3d(self.backbone.conv1(x), (1, 3, 3), (1, 2, 2), (0, 1, 1))
        for stage in range(1, 5):
            x = getattr(self.backbone, f"layer{stage}")(x)
        return self.cls_head.fc_cls(x.mean((2, 3, 4)))


class SimpleBaseline(nn.Module):
    """A ResNet-50 with the head of Xiao, Wu and Wei 2018, with Microsoft's names."""

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
        return self.final_layer(self.deconv_layers(x))


def make(name):
    if name == "simple_baseline":
        return SimpleBaseline(), (1, 3, 256, 192)
    if name == "slowonly_mm":
        return SlowOnly(), (1, 3, 8, 256, 256)
    return getattr(torchvision.models, name)(weights=None), (1, 3, 224, 224)


def randomise(model):
    """Sets batch norms to values that are not trivial to fold."""
    for module in model.modules():
        if isinstance(module, nn.modules.batchnorm._BatchNorm):
            nn.init.normal_(module.running_mean, 0, 0.1)
            nn.init.uniform_(module.running_var, 0.5, 1.5)
            nn.init.uniform_(module.weight, 0.5, 1.0)
            nn.init.normal_(module.bias, 0, 0.1)
    return model.eval()


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or MODELS:
        torch.manual_seed(1)
        model, shape = make(name)
        model = randomise(model)
        clip = torch.randn(shape)
        with torch.no_grad():
            scores = model(clip)
        save_file(model.state_dict(), folder / f"{name}.safetensors")
        np.save(folder / f"{name}_input.npy", clip.numpy())
        np.save(folder / f"{name}_scores.npy", scores.numpy())
        torch.onnx.export(model, clip, folder / f"{name}.onnx", dynamo=False)
        torch.jit.save(torch.jit.trace(model, clip), folder / f"{name}.pt")


main()
