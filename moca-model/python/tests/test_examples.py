"""The examples run, and the types that are stated are those that there are."""

import doctest
import subprocess
import sys

import pytest
from support import PACKAGE, run_example

import ahqp
from ahqp import collaboration, ergo, simulation, vision, whole_body


def test_two_levels():
    first, second = run_example("two_levels").splitlines()
    assert [float(x) for x in first.strip("[]").split(",")] == pytest.approx([1.5, 0.5], abs=1e-12)
    assert second.startswith("[-1.0, 3.0")


def test_examples_are_short():
    lines = (PACKAGE / "examples/panda_circle.py").read_text().splitlines()
    assert len(lines) <= 20


@pytest.fixture(scope="module")
def population():
    return run_example("population", "--people", "2", "--workers", "2")


def test_a_population_is_the_same_in_shards(population):
    head, *rows = population.splitlines()
    assert head == "person,stature,x,y,z,rmse" and len(rows) == 2
    shards = [run_example("population", "--people", "2", "--workers", "1", "--shard", f"{i}/2") for i in (2, 1)]
    assert sorted(row for shard in shards for row in shard.splitlines()[1:]) == rows


def test_a_population_is_the_same_on_dask(population):
    pytest.importorskip("distributed")
    assert run_example("population", "--people", "2", "--workers", "2", "--on", "dask") == population


@pytest.mark.parametrize("module", [ahqp, collaboration, ergo, simulation, vision, whole_body])
def test_everything_has_a_docstring_and_their_examples_run(module):
    runner = doctest.DocTestRunner()
    for name in module.__all__:
        thing = getattr(module, name)
        members = vars(thing) if isinstance(thing, type) else {}
        public = [member for key, member in members.items() if not key.startswith("_")]
        for described in [thing, *public]:
            assert described.__doc__, described
        runner.run(doctest.DocTestParser().get_doctest(thing.__doc__, {}, name, None, 0))
    assert runner.failures == 0


def test_stated_types_are_those_that_there_are(tmp_path):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy.stubtest", "ahqp"]
    run = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 0, run.stdout
