"""Parquet files: every type of column has its one reading, or is refused in one line."""

import datetime as dt
from decimal import Decimal

import numpy as np
import pytest
from trajgap.problem import CaseError
from trajgap.problem.motions import read_motion

pyarrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")


def test_parquet(tmp_path):
    columns = {"time": [0.0, 0.5], "a": [1, 2], "a velocity": [0.5, 0.25]}
    parquet.write_table(pyarrow.table(columns), tmp_path / "a.parquet")
    read = read_motion(tmp_path / "a.parquet")
    assert read.format == "Parquet"
    assert read.content.velocity.tolist() == [[0.5], [0.25]]
    (tmp_path / "b.parquet").write_bytes(b"PAR1 no")
    with pytest.raises(CaseError, match="no Parquet table"):
        read_motion(tmp_path / "b.parquet")


DAY = dt.datetime(2026, 1, 1, 23, 59, 58)
STEPS = [0.25, 0.75, 1.5]  # s
LATER = [DAY + dt.timedelta(seconds=one) for one in STEPS]


@pytest.mark.parametrize(
    ("kind", "values", "times"),
    [
        *((f"timestamp('{unit}')", LATER, [0, 0.5, 1.25]) for unit in ("ms", "us", "ns")),
        ("timestamp('ns', 'Asia/Tokyo')", LATER, [0, 0.5, 1.25]),
        ("timestamp('s')", [3, 5, 6], [0, 2, 3]),
        ("duration('s')", [3, 5, 6], [3, 5, 6]),
        ("duration('ms')", [250, 750, 1500], [0.25, 0.75, 1.5]),
        ("duration('us')", [250, 750, 1500], [0.00025, 0.00075, 0.0015]),
        ("duration('ns')", [250, 750, 1500], [2.5e-7, 7.5e-7, 1.5e-6]),
        ("time32('s')", [3, 5, 6], [0, 2, 3]),
        ("time32('ms')", [250, 750, 1500], [0, 0.5, 1.25]),
        ("time64('us')", [250, 750, 1500], [0, 0.0005, 0.00125]),
        ("time64('ns')", [250, 750, 1500], [0, 5e-7, 1.25e-6]),
        ("date32()", [3, 5, 6], [0, 172800, 259200]),
        ("date64()", [3 * 86400000, 5 * 86400000, 6 * 86400000], [0, 172800, 259200]),
        ("float32()", [0.25, 0.75, 1.5], STEPS),
        ("decimal128(5, 2)", [Decimal("0.25"), Decimal("0.75"), Decimal("1.50")], STEPS),
        ("dictionary(int8(), float64())", [0.25, 0.75, 1.5], STEPS),
        ("dictionary(int8(), int64())", [1, 2, 3], "int64 without a unit"),
        ("int64()", [1, 2, 3], "time: holds int64 without a unit; name it time_s"),
        ("uint8()", [1, 2, 3], "holds uint8 without a unit"),
        ("decimal128(5, 0)", [Decimal(1), Decimal(2), Decimal(3)], "without a unit"),
        ("bool_()", [False, True, True], "holds bool"),
        ("string()", ["0.1", "0.2", "0.3"], "holds string, which is no number"),
        ("list_(float64())", [[0.1], [0.2], [0.3]], "which is no number"),
        ("struct([('sec', int32())])", [{"sec": 1}] * 3, "which is no number"),
        ("float64()", [0.25, None, 1.5], "has no time in row 2"),
        ("null()", [None] * 3, "has no time in row 1"),
        ("float64()", [0.25, float("nan"), 1.5], "number 2 is not finite"),
        ("timestamp('ns')", [-(2**63) + 1, 0, 2**63 - 1], "spans more than is read"),
    ],
)
def test_times_of_a_parquet_file_by_their_type(tmp_path, kind, values, times):
    of = eval(f"pyarrow.{kind}", {**vars(pyarrow), "pyarrow": pyarrow})
    column = pyarrow.array(values, of)
    path = tmp_path / "a.parquet"
    parquet.write_table(pyarrow.table({"time": column, "a": [1.0, 2.0, 4.0]}), path)
    if isinstance(times, str):
        with pytest.raises(CaseError, match=times):
            read_motion(path)
        return
    np.testing.assert_allclose(read_motion(path).content.time, times, rtol=1e-15)


@pytest.mark.parametrize(
    ("label", "values", "wanted"),
    [
        ("a", [True, False], "a: holds bool, which is no number"),
        ("a", ["1", "2"], "a: holds string"),
        ("a", [dt.timedelta(1), dt.timedelta(2)], "a: holds duration"),
        ("a", [DAY, DAY], "a: holds timestamp"),
        ("a", [1.0, None], "joint a in sample 2 is not finite"),
        ("a", [2**62 + 1, 0], "no Parquet table"),  # float64 would round it
        ("__index_level_0__", [1, 2], "is the index of a data frame"),
    ],
)
def test_positions_of_a_parquet_file_are_numbers(tmp_path, label, values, wanted):
    parquet.write_table(pyarrow.table({"time_s": [0, 1], label: values}), tmp_path / "a.parquet")
    with pytest.raises(CaseError, match=wanted):
        read_motion(tmp_path / "a.parquet")
