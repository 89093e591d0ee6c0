"""Arrays as bytes that a general compressor packs well, and exactly back."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mission.errors import UsageError

SMALL = 1024
"""Arrays of fewer values are kept as they are."""
_BLOCK = 1 << 17
"""Values worked on at a time, so that they stay in the processor's cache."""
EXACT = 1 << 24
"""Up to here float32 holds every whole number."""
WHOLE = ("<i2", "<u2", "<i4")
"""Types of whole multiples."""
KINDS = "biuf"
"""What arrays may hold: truth values, whole numbers, floating point numbers (`numpy.dtype.kind`)."""


@dataclass(frozen=True)
class PackedArray:
    """An array as bytes."""

    dtype: str
    """In numpy's notation, "<f4" say."""
    shape: tuple[int, ...]
    steps: float
    """Values are whole multiples of 1 / steps, and kept as such; 0 where they are not."""
    whole: str
    """Type of the whole numbers, one of `WHOLE`; empty where `steps` is 0. The last of its numbers stands for NaN."""
    planes: int
    """How many bytes of each value are kept, lowest first, all values' first bytes before the second ones; 0 for an
    array that is kept as it is, truth values as bits."""
    data: bytes


def pack(array: NDArray[Any], *, steps: float = 0.0) -> PackedArray:
    """Make bytes of an array.

    Neighbours along a row of an image are much alike: whole numbers are kept as differences from the one before. The
    bytes of differences and of floating point numbers are sorted by their significance, so that like stands by like.

    Args:
        array: Of truth values or numbers.
        steps: If not 0, values that are whole multiples of 1 / steps (or NaN) are kept as whole numbers.
    """
    name = array.dtype.newbyteorder("<").str
    shape = np.shape(array)
    array = np.ascontiguousarray(array, name)
    if array.dtype.kind == "b":
        return PackedArray(name, shape, 0.0, "", 0, np.packbits(array.view(np.uint8)).tobytes())
    if array.size < SMALL:
        return PackedArray(name, shape, 0.0, "", 0, array.tobytes())
    rows = array.reshape(1, -1) if array.ndim == 1 else array
    if steps and name == "<f4":
        try:
            whole = _width(rows, steps)
            planes = _planes(rows, lambda block: _differences(_whole(block, steps, whole)), whole.itemsize)
            return PackedArray(name, shape, steps, whole.str, len(planes), planes.tobytes())
        except _NotWholeError:
            return pack(array)
    planes = _planes(rows, (lambda block: block) if array.dtype.kind == "f" else _differences, array.itemsize)
    return PackedArray(name, shape, 0.0, "", len(planes), planes.tobytes())


def unpack(packed: PackedArray) -> NDArray[Any]:
    """The array that was packed.

    Raises:
        UsageError: The bytes do not make an array of that type and shape; found out before memory is taken for it.
    """
    dtype = _dtype(packed.dtype)
    count = math.prod(packed.shape)
    bits = 1 if dtype.kind == "b" else 8 * (packed.planes or dtype.itemsize)
    sound = min(packed.shape, default=0) >= 0 and len(packed.data) == (count * bits + 7) // 8
    if packed.steps:
        sound &= (
            packed.dtype == "<f4" and packed.whole in WHOLE and 0 < packed.planes <= np.dtype(packed.whole).itemsize
        )
    if not sound or packed.planes not in range(dtype.itemsize + 1) or (packed.planes and not count):
        raise UsageError(f"{len(packed.data)} bytes are no array of {packed.dtype} and shape {list(packed.shape)}")
    raw = np.frombuffer(packed.data, np.uint8)
    if dtype.kind == "b":
        return np.unpackbits(raw, count=count).view(bool).reshape(packed.shape)
    if not packed.planes:
        return raw.copy().view(dtype).reshape(packed.shape)
    values = np.empty(packed.shape, dtype)
    rows = values.reshape(1, -1) if values.ndim == 1 else values
    planes = raw.reshape(packed.planes, *rows.shape)
    _each_block(rows, lambda block: _unpack_block(planes[:, block], rows[block], packed))
    return values


class _NotWholeError(Exception):
    """Values are no whole multiples of what they were said to be."""


def _dtype(name: str) -> np.dtype:
    try:
        dtype = np.dtype(name)
    except TypeError as error:
        raise UsageError(f"unknown type of array {name!r}") from error
    if dtype.kind not in KINDS or dtype.itemsize > 8 or dtype.str != name:
        raise UsageError(f"unknown type of array {name!r}")
    return dtype


def _each_block(rows: NDArray[np.generic], work: Callable[[slice], object]) -> None:
    """Work on some rows after the other, on all cores."""
    step = max(1, _BLOCK * len(rows) // rows.size)
    blocks: Iterable[slice] = (slice(start, start + step) for start in range(0, len(rows), step))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(work, blocks))


def _planes(rows: NDArray[Any], change: Callable[[NDArray[Any]], NDArray[Any]], size: int) -> NDArray[np.uint8]:
    """(P, ...) lowest bytes of all values, changed to a size [bytes], then the next ones, to the last that is not 0."""
    planes = np.empty((size, *rows.shape), np.uint8)
    used = np.zeros(size, bool)
    used[0] = True

    def sort_out(block: slice) -> None:
        values = np.ascontiguousarray(change(rows[block]))
        sorted_out = values.view(np.uint8).reshape(*values.shape, size)
        for place in range(size):
            planes[place, block] = sorted_out[..., place]
            if not used[place] and planes[place, block].any():  # blocks are worked on side by side: only ever set it
                used[place] = True

    _each_block(rows, sort_out)
    return planes[: 1 + int(np.flatnonzero(used)[-1])]


def _unpack_block(planes: NDArray[np.uint8], values: NDArray[Any], packed: PackedArray) -> None:
    """Fill values from their planes."""
    kind = np.dtype(packed.whole) if packed.steps else values.dtype
    joined = np.zeros((*values.shape, kind.itemsize), np.uint8)
    for place, plane in enumerate(planes):
        joined[..., place] = plane
    found = joined.view(kind)[..., 0]
    if kind.kind != "f":
        found = _sums(found)
    if packed.steps:
        np.divide(found, values.dtype.type(packed.steps), out=values, dtype=values.dtype, casting="same_kind")
        values[found == np.iinfo(kind).max] = np.nan
    else:
        values[:] = found


def _width(values: NDArray[Any], steps: float) -> np.dtype:
    """The narrowest type of whole numbers that has room for all values, and one more for NaN.

    Raises:
        _NotWholeError: There is none.
    """
    with np.errstate(invalid="ignore"):
        least, most = float(np.fmin.reduce(values, axis=None)) * steps, float(np.fmax.reduce(values, axis=None)) * steps
    for name in WHOLE:
        limits = np.iinfo(name)
        if not (least < limits.min or most > limits.max - 1) and max(-least, most, 0) < EXACT or np.isnan(least):
            return np.dtype(name)
    raise _NotWholeError


def _whole(values: NDArray[Any], steps: float, kind: np.dtype) -> NDArray[Any]:
    """Multiples of 1 / steps as whole numbers of a type, whose last number stands for NaN.

    Raises:
        _NotWholeError: They do not give the very same values back.
    """
    scaled = values * values.dtype.type(steps)
    lost = np.isnan(values)
    scaled[lost] = 0
    np.rint(scaled, out=scaled)
    whole = scaled.astype(kind)
    scaled /= values.dtype.type(steps)
    bits = f"u{values.itemsize}"  # -0.0 is not 0.0
    same = scaled.view(bits) == values.view(bits)
    same |= lost
    if not same.all():
        raise _NotWholeError
    whole[lost] = np.iinfo(kind).max
    return whole


def _differences(values: NDArray[Any]) -> NDArray[Any]:
    """Each value less the one before it in its row, signs moved to the lowest bit; they wrap round, as in `_sums`."""
    size = values.itemsize
    plain = values.view(f"<u{size}")
    less = plain.copy()
    less[:, 1:] -= plain[:, :-1]
    if size > 1:  # small negative numbers shall have empty upper bytes
        signs = less.view(f"<i{size}") >> (8 * size - 1)
        less <<= np.array(1, less.dtype)
        less ^= signs.view(less.dtype)
    return less


def _sums(differences: NDArray[Any]) -> NDArray[Any]:
    """What `_differences` was made from."""
    size = differences.itemsize
    less = differences.view(f"<u{size}")
    if size > 1:
        one = np.array(1, less.dtype)
        less = (less >> one) ^ (np.array(0, less.dtype) - (less & one))
    return np.cumsum(less, axis=1, dtype=less.dtype).view(differences.dtype)
