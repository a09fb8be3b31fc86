"""Times our networks beside onnxruntime, OpenVINO, PyTorch and tract: one engine at a time, in
turns, so that whatever slows the machine slows all. Prints the medians over the rounds, and the
median of the ratios of each round.

python compare.py FOLDER INFER [--models …] [--threads …] [--engines …] [--rounds N] [--repeat K]
"""

import argparse
import re
import subprocess
import time
from pathlib import Path

import numpy as np


def onnxruntime(folder, name, clip, threads):
    import onnxruntime as ort

    options = ort.SessionOptions()
    options.intra_op_num_threads = threads
    session = ort.InferenceSession(
        str(folder / f"{name}.onnx"), options, providers=["CPUExecutionProvider"]
    )
    return lambda: session.run(None, {session.get_inputs()[0].name: clip})[0]


def openvino(folder, name, clip, threads):
    import openvino as ov

    settings = {
        "INFERENCE_NUM_THREADS": threads,
        "PERFORMANCE_HINT": "LATENCY",
        "INFERENCE_PRECISION_HINT": "f32",
    }
    core = ov.Core()
    request = core.compile_model(str(folder / f"{name}.onnx"), "CPU", settings).create_infer_request()
    return lambda: next(iter(request.infer({0: clip}).values()))


def pytorch(folder, name, clip, threads):
    import torch

    model = torch.jit.optimize_for_inference(torch.jit.load(str(folder / f"{name}.pt")).eval())
    tensor = torch.from_numpy(clip)

    def run():
        torch.set_num_threads(threads)
        with torch.inference_mode():
            return model(tensor).numpy()

    return run


def tract(folder, name, clip, threads):
    import tract

    if threads > 1:
        return None
    model = tract.onnx().load(str(folder / f"{name}.onnx")).into_model().into_runnable()
    return lambda: model.run([clip])[0].to_numpy()


PEERS = {"onnxruntime": onnxruntime, "openvino": openvino, "pytorch": pytorch, "tract": tract}


def peer_median(run, repeat):
    run()
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        run()
        times.append(1e3 * (time.perf_counter() - start))
    return float(np.median(times))


def our_median(infer, folder, name, threads, repeat):
    scores = folder / f"{name}_ours.npy"
    command = [
        infer, "--model", name, "--weights", folder / f"{name}.safetensors",
        folder / f"{name}_input.npy", "--output", scores,
        "--threads", str(threads), "--repeat", str(repeat + 1),
    ]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return float(re.search(r"median ([0-9.]+) ms", printed)[1]), np.load(scores)


def error(scores, expected):
    return float(np.abs(scores - expected).max() / np.abs(expected).max())


def compare(arguments, name, threads):
    folder = arguments.folder
    clip = np.load(folder / f"{name}_input.npy")
    expected = np.load(folder / f"{name}_scores.npy")
    peers = {}
    for engine in arguments.engines:
        try:
            run = PEERS[engine](folder, name, clip, threads)
            if run is not None and error(np.asarray(run()), expected) < 1e-3:
                peers[engine] = run
        except Exception as reason:  # An engine that cannot run a network is left out.
            print(f"{name}: no {engine}: {str(reason).splitlines()[0]}")
    times = {engine: [] for engine in ("ours", *peers)}
    for _ in range(arguments.rounds):
        median, scores = our_median(arguments.infer, folder, name, threads, arguments.repeat)
        times["ours"].append(median)
        for engine, run in peers.items():
            times[engine].append(peer_median(run, arguments.repeat))
            time.sleep(0.05)
    print(f"{name}, {threads} thread(s): ours {np.median(times['ours']):.1f} ms, "
          f"error {error(scores, expected):.1e}")
    for engine in peers:
        ratio = np.median(np.divide(times["ours"], times[engine]))
        print(f"    {engine:12} {np.median(times[engine]):8.1f} ms, ours over it {ratio:.2f}")
    if {"onnxruntime", "openvino"} <= peers.keys():
        faster = np.minimum(times["onnxruntime"], times["openvino"])
        ratio = np.median(np.divide(times["ours"], faster))
        print(f"    ours over the faster of onnxruntime and OpenVINO {ratio:.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("infer", type=Path)
    parser.add_argument("--models", nargs="+", default=["resnet50", "resnet152", "slowonly_mm", "simple_baseline"])
    parser.add_argument("--threads", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--engines", nargs="+", choices=PEERS, default=list(PEERS))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--repeat", type=int, default=10)
    arguments = parser.parse_args()
    for name in arguments.models:
        for threads in arguments.threads:
            compare(arguments, name, threads)


main()
