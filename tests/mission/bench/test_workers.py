"""Workers: every task's result comes back under its number, whatever runs it."""

from __future__ import annotations

import os
from functools import partial
from operator import mul

import dask
import pytest
from dask.distributed import Client, LocalCluster

from mission.bench.parallel import Workers, default_jobs


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize("backend", ["loky", "multiprocessing"])  # like Ray's, the second one has no generator
def test_results_come_back_under_the_numbers_of_their_tasks(backend: str, jobs: int) -> None:
    with Workers(backend, jobs) as workers:
        assert sorted(workers.run([partial(mul, k, k) for k in range(5)])) == [(0, 0), (1, 1), (2, 4), (3, 9), (4, 16)]


def test_an_error_in_a_task_is_the_callers() -> None:
    with Workers("loky", 2) as workers, pytest.raises(ZeroDivisionError):
        list(workers.run([partial(divmod, 1, 0)]))


@pytest.mark.slow
def test_dask_uses_the_cluster_that_its_configuration_names() -> None:
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        with dask.config.set(scheduler_address=cluster.scheduler_address), Workers("dask", 7) as workers:
            workers_seen = {process for _, process in workers.run([os.getpid] * 4)}
        with Client(cluster) as client:
            assert workers_seen <= set(client.run(os.getpid).values())


def test_there_is_at_least_one_worker() -> None:
    assert default_jobs() >= 1
