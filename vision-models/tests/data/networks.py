"""Scores of the networks by PyTorch 2, for tests/it/networks.rs.

pip install torch torchvision mmaction2==1.2.0 mmengine "mmcv-lite<2.2" pytorchvideo fvcore iopath
python networks.py > networks.json

Weights and inputs are the numbers of tests/it/support.rs, so that no file of weights is needed.
Of the logits only the first are kept, and of the features every sixteenth.
"""

import json
import sys
import types

import numpy as np
import torch
import torchvision

# mmaction2 1.2.0's wheel lacks this module, which nothing here uses.
for name in ("mmaction.models.localizers.drn", "mmaction.models.localizers.drn.drn"):
    sys.modules[name] = types.ModuleType(name)
sys.modules["mmaction.models.localizers.drn.drn"].DRN = object

from mmaction.models.backbones.resnet3d_slowfast import ResNet3dSlowFast  # noqa: E402
from mmaction.models.backbones.resnet3d_slowonly import ResNet3dSlowOnly  # noqa: E402
from pytorchvideo.models.hub import slow_r50, slowfast_r50  # noqa: E402


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
    state = model.state_dict()
    for name, tensor in state.items():
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


class Recogniser(torch.nn.Module):
    """mmaction2's recogniser in test mode: backbone, average pool, linear layer."""

    def __init__(self, depth, features, classes):
        super().__init__()
        self.backbone = ResNet3dSlowOnly(
            depth=depth, pretrained=None, lateral=False, conv1_kernel=(1, 7, 7), conv1_stride_t=1,
            pool1_stride_t=1, inflate=(0, 0, 1, 1), norm_eval=False,
        )
        self.cls_head = torch.nn.Module()
        self.cls_head.fc_cls = torch.nn.Linear(features, classes)

    def forward(self, clip):
        return self.cls_head.fc_cls(self.backbone(clip).mean((2, 3, 4)))


class TwoPaths(torch.nn.Module):
    """mmaction2's SlowFast in test mode: the features of the fast path come first."""

    def __init__(self, depth, slowness, fusion_kernel, classes):
        super().__init__()
        self.backbone = ResNet3dSlowFast(
            pretrained=None, resample_rate=slowness, speed_ratio=slowness, channel_ratio=8,
            slow_pathway=dict(
                type="resnet3d", depth=depth, pretrained=None, lateral=True,
                fusion_kernel=fusion_kernel, conv1_kernel=(1, 7, 7), dilations=(1, 1, 1, 1),
                conv1_stride_t=1, pool1_stride_t=1, inflate=(0, 0, 1, 1), norm_eval=False,
            ),
            fast_pathway=dict(
                type="resnet3d", depth=depth, pretrained=None, lateral=False, base_channels=8,
                conv1_kernel=(5, 7, 7), conv1_stride_t=1, pool1_stride_t=1, norm_eval=False,
            ),
        )
        self.cls_head = torch.nn.Module()
        self.cls_head.fc_cls = torch.nn.Linear(2304, classes)

    def forward(self, clip):
        slow, fast = self.backbone(clip)
        return self.cls_head.fc_cls(torch.cat([fast.mean((2, 3, 4)), slow.mean((2, 3, 4))], 1))


def slow_fast(model, clip):
    slow = torch.linspace(0, clip.shape[2] - 1, clip.shape[2] // 4).long()
    return model([clip.index_select(2, slow), clip])


def golden(model, linear, shape, run=lambda model, clip: model(clip)):
    model = fill(model)
    seen = []
    linear(model).register_forward_pre_hook(lambda _, inputs: seen.append(inputs[0]))
    clip = torch.from_numpy(numbers("input", shape).astype(np.float32))
    with torch.no_grad():
        logits = run(model, clip)
    if linear(model).__class__ is torch.nn.Identity:
        logits = torch.zeros(1, 0)
    # PyTorchVideo applies the linear layer at each position of its pool, channels last.
    features = seen[0].flatten(1, -2).mean(1) if seen[0].dim() > 2 else seen[0]
    return {
        "shape": shape,
        "classes": logits.shape[1],
        "logits": [float(value) for value in logits.flatten()[:64]],
        "largest_logit": float(logits.abs().max()) if logits.numel() else 0.0,
        "features": [float(value) for value in features.flatten()[::16]],
        "largest_feature": float(features.abs().max()),
    }


def main():
    resnet = torchvision.models
    fc = lambda model: model.fc  # noqa: E731
    head = lambda model: model.cls_head.fc_cls  # noqa: E731
    result = {
        f"resnet{depth}": golden(
            getattr(resnet, f"resnet{depth}")(num_classes=12), fc, (1, 3, 64 + depth % 32, 96)
        )
        for depth in (18, 34, 50, 101, 152)
    }
    for name in ("resnext50_32x4d", "wide_resnet50_2"):
        result[name] = golden(getattr(resnet, name)(num_classes=12), fc, (1, 3, 64, 80))
    dropout = resnet.resnet18()
    dropout.fc = torch.nn.Sequential(torch.nn.Dropout(), torch.nn.Linear(512, 12))
    result["resnet18_dropout"] = golden(dropout, lambda model: model.fc[1], (1, 3, 64, 96))
    headless = resnet.resnet18()
    headless.fc = torch.nn.Identity()
    result["resnet18_headless"] = golden(headless, fc, (1, 3, 64, 96))
    result["slowonly_mm"] = golden(Recogniser(50, 2048, 30), head, (1, 3, 8, 96, 112))
    result["slowonly_r18_mm"] = golden(Recogniser(18, 512, 30), head, (1, 3, 5, 112, 80))
    result["slowonly_r101_mm"] = golden(Recogniser(101, 2048, 30), head, (1, 3, 4, 64, 80))
    result["slowfast_r50_4x16_mm"] = golden(TwoPaths(50, 8, 5, 30), head, (1, 3, 32, 64, 80))
    result["slowfast_r101_8x8_mm"] = golden(TwoPaths(101, 4, 7, 30), head, (1, 3, 32, 64, 48))
    proj = lambda index: lambda model: model.blocks[index].proj  # noqa: E731
    result["slowonly_ptv"] = golden(
        slow_r50(model_num_class=30), proj(5), (1, 3, 9, 240, 200)
    )
    result["slowfast_ptv"] = golden(
        slowfast_r50(model_num_class=30), proj(6), (1, 3, 32, 200, 240), slow_fast
    )
    json.dump(result, sys.stdout, indent=1)


main()
