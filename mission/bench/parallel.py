"""Many tasks on the cores of this machine, or on a cluster, through joblib."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from typing import Any, TypeVar

from mission.errors import UsageError

BACKENDS = ("loky", "dask", "ray")
"""Processes on this machine; a Dask or a Ray cluster."""

T = TypeVar("T")


class Workers:
    """Workers that run tasks; a context manager.

    `dask` connects to the scheduler that DASK_SCHEDULER_ADDRESS names, `ray` to the cluster of RAY_ADDRESS; where the
    variable is not set they start workers here.
    """

    def __init__(self, backend: str, jobs: int) -> None:
        """Choose the workers.

        Args:
            backend: One of `BACKENDS`.
            jobs: How many tasks run at a time on this machine; a cluster runs as many as it has workers.
        """
        self._backend, self._jobs = backend, jobs
        self._closing = ExitStack()

    def __enter__(self) -> Workers:
        import joblib

        with ExitStack() as closing:
            if self._backend == "dask":
                self._jobs = _start_dask(closing, self._jobs)
            elif self._backend == "ray":
                self._jobs = _start_ray(self._jobs)
            closing.enter_context(joblib.parallel_config(self._backend, n_jobs=self._jobs))
            closing.enter_context(warnings.catch_warnings())  # loky replaces workers that have grown: nothing is lost
            warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)
            self._closing = closing.pop_all()
        return self

    def __exit__(self, *error: Any) -> None:
        self._closing.close()

    def run(self, tasks: Iterable[Callable[[], T]]) -> Iterator[tuple[int, T]]:
        """Run tasks, which are pickled.

        Yields:
            The number of a task and what it returned, in the order in which they end; with Ray, all at the end.
        """
        import joblib

        backend, _ = joblib.parallel.get_active_backend()
        return_as = "generator_unordered" if backend.supports_return_generator else "list"
        parallel = joblib.Parallel(return_as=return_as, batch_size=1, pre_dispatch="2*n_jobs")
        yield from parallel(joblib.delayed(_numbered)(number, task) for number, task in enumerate(tasks))


def default_jobs() -> int:
    """As many as this process may use cores."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _numbered(number: int, task: Callable[[], T]) -> tuple[int, T]:
    return number, task()


def _start_dask(closing: ExitStack, jobs: int) -> int:
    try:
        import dask
        from dask.distributed import Client, LocalCluster
    except ImportError:
        raise UsageError("--backend dask needs Dask: pip install 'door-mission[bench]'") from None
    if dask.config.get("scheduler-address", None):
        closing.enter_context(Client())
        return -1  # all that it has
    cluster = closing.enter_context(LocalCluster(n_workers=jobs, threads_per_worker=1, dashboard_address=":0"))
    closing.enter_context(Client(cluster))
    return jobs


def _start_ray(jobs: int) -> int:
    try:
        from ray.util.joblib import register_ray
    except ImportError:
        raise UsageError("--backend ray needs Ray: pip install 'ray[default]'") from None
    register_ray()
    return -1 if os.environ.get("RAY_ADDRESS") else jobs
