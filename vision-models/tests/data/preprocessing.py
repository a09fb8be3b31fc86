"""Writes what Pillow, OpenCV, torchvision and PyTorch make of generated frames.

Needs torch, torchvision, pillow before 13, numpy and opencv-python-headless (written with Pillow
12.0, OpenCV 4.14; OpenCV 5.0 gives the same):
    python preprocessing.py
"""
import json
import random
import zlib

import cv2
import numpy as np
import torch
from PIL import Image
from torchvision import transforms


def frame(height, width):
    """Noise on a gradient; the test generates the same."""
    index = np.arange(height * width * 3, dtype=np.uint64)
    noise = ((index * 2654435761) & 0xFFFFFFFF) >> 24
    row = index // (3 * width)
    return ((noise + row * 5) & 255).astype(np.uint8).reshape(height, width, 3)


def sizes():
    yield 480, 640, 255, 340
    yield 480, 640, 255, 255
    yield 480, 640, 256, 341
    yield 480, 720, 256, 384
    yield 512, 682, 256, 341  # exactly half
    yield 10, 10, 10, 20
    yield 10, 10, 20, 10
    random.seed(6)
    for _ in range(60):
        yield tuple(random.randint(1, 90) for _ in range(4))


resized = []
for height, width, to_height, to_width in sizes():
    pixels = frame(height, width)
    pillow = np.asarray(Image.fromarray(pixels).resize((to_width, to_height), Image.BILINEAR))
    opencv = cv2.resize(pixels, (to_width, to_height), interpolation=cv2.INTER_LINEAR)
    resized.append([height, width, to_height, to_width, zlib.crc32(pillow.tobytes()), zlib.crc32(opencv.tobytes())])

# Whole pipelines, every 7th value in C order.
pipelines = []
for height, width in [(48, 64), (64, 48), (61, 97), (31, 31), (480, 640)]:
    pixels = frame(height, width)
    normalise = transforms.Normalize([0.485, 0.456, 0.406], [0.229, 0.224, 0.225])
    torchvision = transforms.Compose([transforms.Resize(31), transforms.CenterCrop(24), transforms.ToTensor(), normalise])(Image.fromarray(pixels))
    square = transforms.Compose([transforms.Resize((31, 31)), transforms.CenterCrop(24), transforms.ToTensor(), normalise])(Image.fromarray(pixels))

    # mmaction2: Resize(scale=(-1, 31)), CenterCrop(24), ActionDataPreprocessor.
    scale = 31 / min(height, width)
    to_height, to_width = int(height * scale + 0.5), int(width * scale + 0.5)
    small = cv2.resize(pixels, (to_width, to_height), interpolation=cv2.INTER_LINEAR)
    top, left = (to_height - 24) // 2, (to_width - 24) // 2
    crop = torch.from_numpy(small[top : top + 24, left : left + 24].copy()).permute(2, 0, 1).float()
    mean, std = (torch.tensor(v).view(3, 1, 1) for v in ([123.675, 116.28, 103.53], [58.395, 57.12, 57.375]))
    mmaction2 = (crop - mean) / std

    # PyTorchVideo: division by 255, Normalize, ShortSideScale(31), CenterCropVideo(24).
    clip = (torch.from_numpy(pixels).permute(2, 0, 1).float() / 255.0 - 0.45) / 0.225
    if width < height:
        to_height, to_width = int(float(height) / width * 31), 31
    else:
        to_height, to_width = 31, int(float(width) / height * 31)
    small = torch.nn.functional.interpolate(clip[None], size=(to_height, to_width), mode="bilinear", align_corners=False)[0]
    top, left = int(round((to_height - 24) / 2.0)), int(round((to_width - 24) / 2.0))
    pytorchvideo = small[:, top : top + 24, left : left + 24]
    pick = lambda tensor: [round(v, 6) for v in tensor.flatten()[::7].tolist()]
    pipelines.append({"size": [height, width], "torchvision": pick(torchvision), "square": pick(square), "mmaction2": pick(mmaction2), "pytorchvideo": pick(pytorchvideo)})


# Clip sampling. mmaction2's formulas (SampleFrames in test mode) as numpy evaluates them.
def mmaction2_indices(frames, length, interval, clips):
    last = max(frames - ((length - 1) * interval + 1), 0)
    starts = np.round(np.arange(clips) * (last / (clips - 1))) if clips > 1 else np.array([last // 2])
    return np.mod(starts[:, None] + np.arange(length) * interval, frames).astype(int).tolist()


def mmaction2_before_1_indices(frames, length, interval, clips):
    span = length * interval
    part = (frames - span + 1) / clips
    starts = (np.arange(clips) * part + part / 2.0).astype(int) if frames > span - 1 else np.zeros(clips, dtype=int)
    return np.mod(starts[:, None] + np.arange(length) * interval, frames).tolist()


def pytorchvideo_indices(frames, length):
    return torch.clamp(torch.linspace(0, frames - 1, length), 0, frames - 1).long().tolist()


sampling = []
for frames in [1, 2, 7, 8, 29, 30, 31, 32, 33, 45, 60, 61, 100, 299, 300, 1001]:
    for length, interval, clips in [(8, 4, 1), (8, 4, 10), (4, 16, 3), (8, 8, 2), (1, 1, 1), (16, 2, 5)]:
        sampling.append({
            "frames": frames, "length": length, "interval": interval, "clips": clips,
            "mmaction2": mmaction2_indices(frames, length, interval, clips),
            "mmaction2_before_1": mmaction2_before_1_indices(frames, length, interval, clips),
            "pytorchvideo": pytorchvideo_indices(frames, length),
        })

json.dump({"resized": resized, "pipelines": pipelines, "sampling": sampling}, open("preprocessing.json", "w"), separators=(",", ":"))
print(cv2.__version__, Image.__version__, torch.__version__)
