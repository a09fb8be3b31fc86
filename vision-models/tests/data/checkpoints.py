"""Writes the small checkpoints that the tests read, and what is in them.

Needs torch, numpy and safetensors (written with torch 2.15, safetensors 0.8):
    python checkpoints.py
"""
import collections
import io
import json
import pickle
import zipfile

import numpy
import torch
from safetensors.torch import save_file

torch.manual_seed(6)
grid = torch.arange(24, dtype=torch.float32).reshape(4, 6) / 7

tensors = collections.OrderedDict()
tensors["f32"] = torch.randn(2, 3, 4)
tensors["f64"] = torch.randn(3, dtype=torch.float64)
tensors["f16"] = torch.tensor([1.0, -2.5, 6e-8, 65504.0, float("inf")], dtype=torch.float16)
tensors["bf16"] = torch.randn(4).to(torch.bfloat16)
tensors["i64"] = torch.tensor([[-1], [2**40]])
tensors["i32"] = torch.tensor([7, -2**31], dtype=torch.int32)
tensors["i16"] = torch.tensor([-300], dtype=torch.int16)
tensors["i8"] = torch.tensor([-128, 127], dtype=torch.int8)
tensors["u8"] = torch.tensor([0, 255], dtype=torch.uint8)
tensors["bool"] = torch.tensor([True, False, True])
tensors["scalar"] = torch.tensor(0.1)
tensors["count"] = torch.tensor(1234)
tensors["empty"] = torch.zeros(0, 3)
tensors["parameter"] = torch.nn.Parameter(torch.randn(3))
# Views of one storage.
tensors["whole"] = grid
tensors["transposed"] = grid.t()
tensors["offset"] = grid[2]
tensors["strided"] = grid[1:, 1::2]
tensors["expanded"] = grid[3, 5].expand(3)


def expected(state):
    return {
        name: {
            "shape": list(tensor.shape),
            "values": ["inf" if v == float("inf") else v for v in tensor.detach().float().flatten().tolist()],
        }
        for name, tensor in state.items()
    }


torch.save(tensors, "plain.pth")
torch.save(tensors, "stream.pth", _use_new_zipfile_serialization=False)
torch.save(dict(tensors), "protocol5.pth", pickle_protocol=5)
save_file({name: tensor.detach().contiguous().clone() for name, tensor in tensors.items()}, "plain.safetensors")
json.dump(expected(tensors), open("plain.json", "w"), indent=0)

# As in mmaction2: the weights are one of several entries, and others hold foreign objects.
backbone = collections.OrderedDict()
backbone["backbone.conv1.conv.weight"] = torch.randn(4, 3, 1, 2, 2)
backbone["backbone.conv1.bn.bias"] = torch.randn(4)
backbone["cls_head.fc_cls.bias"] = torch.randn(2)
backbone._metadata = collections.OrderedDict([("", {"version": 1})])
net = torch.nn.Linear(2, 2)
optimiser = torch.optim.SGD(net.parameters(), lr=0.1, momentum=0.9)
net(torch.ones(2)).sum().backward()
optimiser.step()
wrapped = {
    "meta": {"epoch": 3, "loss": numpy.float64(0.25), "rng": numpy.arange(3), "when": collections.Counter("abc")},
    "state_dict": backbone,
    "message_hub": {"log_scalars": collections.defaultdict(list, {"lr": [0.1]}), "set": {1, 2}},
    "optimizer": optimiser.state_dict(),
}
torch.save(wrapped, "wrapped.pth")
json.dump(expected(backbone), open("wrapped.json", "w"), indent=0)

# As in PyTorchVideo after training on several GPUs.
torch.save({"model_state": {"module." + k: v for k, v in backbone.items()}, "cfg": "text"}, "parallel.pyth")


class Hostile:
    def __reduce__(self):
        return (print, ("this must never be printed",))


torch.save({"state_dict": {"f32": tensors["f32"]}, "hostile": Hostile()}, "hostile.pth")

# Big-endian, as declared in the archive.
with zipfile.ZipFile("plain.pth") as plain, zipfile.ZipFile("big_endian.pth", "w") as big:
    for name in plain.namelist():
        big.writestr(name, b"big" if name.endswith("byteorder") else plain.read(name))
with zipfile.ZipFile("plain.pth") as plain, zipfile.ZipFile("compressed.pth", "w", zipfile.ZIP_DEFLATED) as out:
    for name in plain.namelist():
        out.writestr(name, plain.read(name))
