"""Samples as they are kept: what was sent comes back."""

from dataclasses import replace

import numpy as np
import pytest

from api.formats import parse, raw
from api.formats.writer import write_native_csv
from core import Samples
from core.simulation import Scenario, simulate
from tests.watched import parked

ALL = ("t", "f_s", "w_s", "fix_row", "fix_valid", "fix", "m_s", "steer", "temperature", "pressure")


def sent(samples: Samples) -> Samples:
    """Give samples as the service reads them."""
    return parse(write_native_csv(samples), "text/csv", None).samples().samples


def city(**options: object) -> Samples:
    return simulate(Scenario("city", 30.0, 2, imu_rate=50.0, **options)).samples  # type: ignore[arg-type]


def with_everything() -> Samples:
    samples = city()
    n = len(samples)
    m_s = np.tile([20.0, -5.5, 41.25], (n, 1))
    m_s[10:20] = np.nan
    temperature = np.full(n, np.nan)
    temperature[::50] = 21.25
    return replace(samples, m_s=m_s, steer=np.linspace(-1, 1, n), temperature=temperature, pressure=np.full(n, 99876.5))


def assert_same(one: Samples, other: Samples) -> None:
    """Compare numbers by the 32 bits they are kept with; time and position to the last bit."""
    for name in ALL:
        a, b = getattr(one, name), getattr(other, name)
        assert (a is None) == (b is None), name
        if a is not None:
            np.testing.assert_allclose(b, a, rtol=2e-7, atol=1e-12, err_msg=name)
    np.testing.assert_array_equal(one.t, other.t)
    np.testing.assert_array_equal(one.fix_row, other.fix_row)
    np.testing.assert_array_equal(one.fix_valid, other.fix_valid)
    np.testing.assert_array_equal(one.fix[:, :2], other.fix[:, :2])


@pytest.mark.parametrize("samples", [city(), with_everything(), parked(3.0), parked(3.0, fix=False)])
def test_what_was_sent_comes_back(samples: Samples) -> None:
    before = sent(samples)
    after = raw.unpack(raw.pack(before))
    assert_same(before, after)
    assert_same(after, raw.unpack(raw.pack(after)))


def test_numbers_of_32_bits_come_back_to_the_last_bit() -> None:
    before = raw.unpack(raw.pack(sent(with_everything())))
    after = raw.unpack(raw.pack(before))
    for name in ALL:
        np.testing.assert_array_equal(getattr(before, name), getattr(after, name))


def test_a_position_of_eleven_decimals_comes_back_to_the_last_bit() -> None:
    generator = np.random.default_rng(4)
    degrees = np.round(generator.uniform([-90, -180], [90, 180], (2000, 2)), 11)
    fix = np.full((2000, 8), np.nan)
    fix[:, :2] = np.radians(degrees)
    t = np.arange(2000.0)
    before = Samples.make(t, np.zeros((2000, 3)), None, np.arange(2000), np.ones(2000, np.bool_), fix)
    np.testing.assert_array_equal(raw.unpack(raw.pack(before)).fix, before.fix)


def test_columns_that_nothing_fills_are_left_out() -> None:
    bare = Samples.make(np.arange(3.0), np.ones((3, 3)))
    assert raw.names(raw.pack(bare)) == ("t", "ax", "ay", "az", "fix", "speed", "course")
    assert {"mx", "my", "mz", "steer", "temp", "pressure"} <= set(raw.names(raw.pack(with_everything())))


def test_a_report_that_there_is_no_fix_stays_one() -> None:
    samples = sent(parked(0.0, 30.0, fix=False))
    assert samples.fix_row.size > 10
    after = raw.unpack(raw.pack(samples))
    assert not after.fix_valid.any()
    np.testing.assert_array_equal(after.fix_row, samples.fix_row)


def test_named_columns_are_there_though_empty() -> None:
    bare = Samples.make(np.arange(3.0), np.ones((3, 3)))
    table = raw.batch(bare, ("gx", "t", "ax", "ay", "az", "gy", "gz", "fix", "lat", "lon"))
    assert table.schema.names == ["t", "ax", "ay", "az", "gx", "gy", "gz", "fix", "lat", "lon"]
    assert table["gx"].null_count == table["lat"].null_count == table["fix"].null_count == 3
