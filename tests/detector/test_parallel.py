"""Work side by side: the answer is that of a plain loop, whatever the number of processors."""

from __future__ import annotations

import threading
from functools import partial
from time import sleep
from weakref import ref

import numpy as np
import pytest

from detector.parallel import each, processors


def test_results_come_in_the_order_of_the_items_and_not_of_their_completion() -> None:
    def slow_first(i: int) -> int:
        sleep(0.02 if i == 0 else 0)
        return i * i

    assert each(slow_first, range(6)) == [0, 1, 4, 9, 16, 25]


def test_a_call_within_a_call_within_a_call_comes_to_an_end() -> None:
    def tree(depth: int) -> int:
        return 1 if depth == 0 else sum(each(tree, [depth - 1] * 4))

    assert tree(4) == 256  # 4^4 leaves


def test_no_more_threads_work_than_there_are_processors() -> None:
    at_work: set[int] = set()
    each(lambda _: (at_work.add(threading.get_ident()), sleep(0.01)), range(20))
    assert len(at_work) <= max(2, processors())


def test_an_error_of_one_item_comes_out_and_the_next_call_works() -> None:
    with pytest.raises(ZeroDivisionError):
        each(lambda i: 1 // i, range(5))
    assert each(abs, [-1, -2]) == [1, 2] and each(abs, []) == []


def test_a_call_keeps_nothing_of_what_it_worked_on_though_all_threads_are_busy_elsewhere() -> None:
    looked = threading.Event()

    def outer(i: int) -> bool:
        if i == 0:  # the front: where there is a second thread, it is busy until the caller has looked
            return looked.wait(10)
        image = np.zeros(10)
        kept = ref(image)
        each(partial(np.take, image), range(3))
        del image
        looked.set()
        return kept() is None

    assert each(outer, range(2)) == [True, True]
