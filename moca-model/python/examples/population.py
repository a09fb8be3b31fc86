"""Ergonomics maps of a population, on the processes of one machine, on Ray or on Dask: the same result on each.

    python population.py --people 200 --on processes --output population.csv
    python population.py --people 200 --on ray              # the cluster that `ray.init()` finds
    python population.py --people 200 --on dask --scheduler tcp://host:8786
    python population.py --people 200 --shard 2/8           # one of eight tasks of an array job
"""
import argparse
import csv
import math
import random
import sys

from ahqp.ergo import ErgonomicsMap, Person

COLUMNS = ["person", "stature", "x", "y", "z", "rmse"]


def row(case, seed, spacing):
    """Best place to work for the person of a case, and fit of the quadratic; the case alone decides who it is."""
    draw = random.Random(f"{seed}/{case}")
    stature = min(max(draw.gauss(1.70, 0.10), 1.45), 2.00)
    quadratic, report = ErgonomicsMap(Person(stature), spacing=spacing).fit()
    best = quadratic.minimiser()
    return [case, stature, *(best.tolist() if best is not None else [math.nan] * 3), report.rmse]


def on_processes(cases, arguments):
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(arguments.workers) as pool:
        yield from pool.map(row, cases, *constant(cases, arguments))


def on_ray(cases, arguments):
    import ray

    ray.init(num_cpus=arguments.workers, ignore_reinit_error=True)
    remote = ray.remote(row)
    yield from ray.get([remote.remote(case, arguments.seed, arguments.spacing) for case in cases])


def on_dask(cases, arguments):
    from dask.distributed import Client

    address = {"address": arguments.scheduler} if arguments.scheduler else {"n_workers": arguments.workers}
    with Client(**address) as client:
        yield from client.gather(client.map(row, cases, *constant(cases, arguments), pure=False))


def constant(cases, arguments):
    return [arguments.seed] * len(cases), [arguments.spacing] * len(cases)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--people", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spacing", type=float, default=0.08, help="of the grid of each map, in metres, at most 0.08")
    parser.add_argument("--on", choices=["processes", "ray", "dask"], default="processes")
    parser.add_argument("--workers", type=int, help="processes; as many as processors if it is not given")
    parser.add_argument("--scheduler", help="the address of Dask's scheduler")
    parser.add_argument("--shard", default="1/1", help="I/N: every N-th person, from the I-th on")
    parser.add_argument("--output", help="a table; standard output if it is not given")
    arguments = parser.parse_args()
    index, count = map(int, arguments.shard.split("/"))
    if not 1 <= index <= count:
        parser.error("--shard takes I/N with I from 1 to N")
    run = {"processes": on_processes, "ray": on_ray, "dask": on_dask}[arguments.on]
    rows = run(range(index - 1, arguments.people, count), arguments)
    # Tables of shards, one below the other and sorted by the person, are the table of the whole.
    with open(arguments.output, "w", newline="") if arguments.output else sys.stdout as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(rows)


if __name__ == "__main__":
    main()
