"""Linear heads trained by PyTorch's SGD, for tests/it/heads.rs.

pip install torch
python heads.py > heads.json

The batches are part of the file: both go through the same samples in the same order.
"""

import json

import torch

torch.manual_seed(5)
cases = []
for classes, features, momentum, decay, rate in [
    (2, 16, 0.0, 0.0, 0.1), (3, 12, 0.9, 0.0, 0.01), (5, 20, 0.9, 0.01, 0.05),
]:
    count = 40
    labels = torch.arange(count) % classes
    samples = torch.randn(classes, features)[labels] + torch.randn(count, features)
    samples = (samples * 1000).round() / 1000
    layer = torch.nn.Linear(features, classes)
    start = {"weights": layer.weight.tolist(), "biases": layer.bias.tolist()}
    sgd = torch.optim.SGD(layer.parameters(), rate, momentum=momentum, weight_decay=decay)
    batches, losses = [], []
    for _ in range(10):
        for batch in torch.randperm(count).split(7):
            loss = torch.nn.functional.cross_entropy(layer(samples[batch]), labels[batch])
            sgd.zero_grad()
            loss.backward()
            sgd.step()
            batches.append(batch.tolist())
            losses.append(loss.item())
    cases.append({
        "samples": samples.tolist(), "labels": labels.tolist(), "start": start,
        "momentum": momentum, "weight_decay": decay, "learning_rate": rate,
        "batches": batches, "losses": losses,
        "weights": layer.weight.tolist(), "biases": layer.bias.tolist(),
    })
print(json.dumps(cases))
