"""The page on speed shows what the committed measurements say."""

from support.benchmarks import loaded


def test_the_tables_are_those_of_the_measurements() -> None:
    scale = loaded("scale")
    text = scale.PAGE.read_text("utf-8")
    rows = scale.read()
    assert scale.page(text, rows) == text
    long = [row for row in rows if row["question"] == "check" and row["code"] == "ours"]
    assert {row["segments"] for row in long} >= {"100", "1000", "10000", "100000"}
    for curve in ("cubic", "quintic"):
        some = [row for row in long if row["curve"] == curve]
        growth = scale.exponent(some)
        assert growth <= 1.1
