"""The form in the browser: what it takes, what it refuses beside which field, and who may ask."""

import io
import re
import threading
import tomllib
from collections.abc import Iterator
from html import unescape
from tempfile import gettempdir
from typing import Any
from unittest.mock import Mock

import pytest
from support import browser
from support.checkout import ROOT
from trajgap.compare.app import make_server, server
from trajgap.compare.app.server import FormError, case_of, offered_curves
from trajgap.problem import PackageError, TrajgapError, parse_case

flask = pytest.importorskip("flask")

FIELDS = {
    "table": "j1\n0.1\n0.7\n1.3\n0.4",
    "position_unit": "rad",
    "velocity": "2",
    "velocity_unit": "rad/s",
    "durations": "0.7, 0.8, 0.65",
    "time_unit": "s",
    "where": "Table 2",
    "name": "My paper",
}
GUIDE = (ROOT / "docs/guides/form.md").read_text("utf-8")
MOTION = b"time,j1\n0,0\n0.5,0.25\n1,1\n1.5,1.75\n2,2\n"


@pytest.fixture
def client() -> Any:
    return server.make_form().test_client()


def faults(answer: Any) -> dict[str, str]:
    """Faults by field, each of which is marked and described by its fault."""
    text = answer.get_data(as_text=True)
    found = dict(re.findall(r'<strong class="fault" id="(\w+)-fault">(.*?)</strong>', text))
    for name in found:
        if name != "family":
            assert re.search(rf'name="{name}" aria-invalid="true" aria-describedby="{name}-', text)
    assert "Traceback" not in text
    return {name: unescape(why) for name, why in found.items()}


def test_the_form_names_every_field_and_draws_every_curve(client: Any) -> None:
    answer = client.get("/")
    text = answer.get_data(as_text=True)
    labels = set(re.findall(r'<label for="(\w+)"', text))
    inputs = set(re.findall(r'<(?:input|select|textarea)[^>]* id="(\w+)"', text))
    assert inputs == labels
    assert text.count("<svg") == len(offered_curves()) - 1 == 5
    assert not re.search(r'(?:src|href)="(?!data:)', text), "nothing is fetched"
    assert "<script" not in text
    assert "default-src 'none'" in answer.headers["Content-Security-Policy"]


def test_the_page_of_the_audit_appears_and_the_case_file_can_be_saved(client: Any) -> None:
    answer = client.post("/audit", data=FIELDS)
    assert answer.status_code == 303
    page = client.get(answer.location).get_data(as_text=True)
    assert 'class="card"' in page
    assert "2.15 s, which breaks a limit, is 41.9 % below" in page
    folder = answer.location.rpartition("/")[0]
    for target in re.findall(r'(?:src|href)="([^#":]+)"', page):
        address = target if target.startswith("/") else f"{folder}/{target}"
        assert client.get(address).status_code == 200, target
    saved = client.get(f"{folder}/my-paper.toml")
    assert saved.headers["Content-Disposition"] == "attachment"
    case = parse_case(saved.get_data(as_text=True), "my-paper.toml")
    assert case.problem().waypoints[:, 0].tolist() == [0.1, 0.7, 1.3, 0.4]
    assert client.get("/audits/7/my-paper.html").status_code == 404


@pytest.mark.parametrize(
    ("changed", "field", "said"),
    [
        ({"table": " "}, "table", "paste the way-points"),
        ({"table": "j1\n1\nx\n2"}, "table", "line 3"),
        ({"table": "1\n"}, "table", "at least two rows"),
        ({"velocity": "fast"}, "velocity", "'fast' is not a finite decimal number"),
        ({"velocity": "-1"}, "velocity", "-1 is negative"),
        ({"velocity": "1,2"}, "velocity", "lists 2 numbers for 1 joints"),
        ({"velocity_unit": "knots"}, "velocity_unit", "unknown unit 'knots'"),
        ({"position_unit": "turns"}, "position_unit", "unknown unit 'turns'"),
        ({"durations": "1,2"}, "durations", "the curve has 3 segments"),
        ({"total": "soon"}, "total", "'soon' is not a finite decimal number"),
        ({"other": "banana"}, "other", "'banana' is not known"),
        ({"family": "pear"}, "family", "'pear' is not known"),
    ],
)
def test_a_fault_is_one_line_beside_its_field(
    changed: dict[str, str], field: str, said: str, client: Any
) -> None:
    answer = client.post("/audit", data=FIELDS | changed)
    assert answer.status_code == 422
    found = faults(answer)
    assert list(found) == [field]
    assert said in found[field]
    assert "\n" not in found[field]
    assert 'value="Table 2"' in answer.get_data(as_text=True)  # nothing is to be typed again


def test_several_faults_stand_beside_several_fields(client: Any) -> None:
    table = FIELDS["table"].replace("\n", "\r\n")  # as browsers send it
    answer = client.post("/audit", data=FIELDS | {"table": table, "velocity": "x", "total": "y"})
    assert set(faults(answer)) == {"velocity", "total"}
    assert f">{FIELDS['table']}</textarea>" in answer.get_data(as_text=True)


def test_every_curve_of_the_form_is_a_case(client: Any) -> None:
    jerk = {"jerk": "9", "jerk_unit": "rad/s^3", "durations": ""}
    for one in offered_curves():
        text, case = case_of(FIELDS | jerk | {"family": one.family})
        known = tomllib.loads(text)["interpolant"]["family"]
        assert known == (one.family or "3-5-3")
        assert case.problem().segments >= 3


def checked(client: Any, content: bytes = MOTION, name: str = "m.csv", **fields: str) -> Any:
    sent = {"motion": (io.BytesIO(content), name), "motion_unit": "rad", **fields}
    return client.post("/check", data=sent, content_type="multipart/form-data")


def test_a_motion_is_judged(client: Any) -> None:
    slow = checked(client, motion_velocity="1", between="linear").get_data(as_text=True)
    fast = checked(client, motion_velocity="9", between="spline").get_data(as_text=True)
    assert re.search(r'id="verdict".*<strong class="word violated">', slow)
    assert re.search(r'id="verdict".*<strong class="word pass">', fast)
    assert "m.csv, interpolation spline" in fast


@pytest.mark.parametrize(
    ("content", "fields", "field", "said"),
    [
        (b"", {"motion_velocity": "1"}, "motion", "choose a file"),
        (b"time,j1\n0,a\n", {"motion_velocity": "1"}, "motion", "line 2"),
        (b"\xff\xfe\x00", {"motion_velocity": "1"}, "motion", ""),
        (MOTION, {}, "motion_velocity", "give at least one limit"),
        (MOTION, {"motion_jerk": "x"}, "motion_jerk", "'x'"),
        (MOTION, {"motion_velocity": "1", "between": "straight"}, "between", "'straight'"),
    ],
)
def test_a_motion_that_cannot_be_judged(
    content: bytes, fields: dict[str, str], field: str, said: str, client: Any
) -> None:
    found = faults(checked(client, content, **fields))
    assert list(found) == [field]
    assert said in found[field]
    assert gettempdir() not in found[field]


def test_no_other_site_and_no_other_name_reaches_it(client: Any) -> None:
    assert client.get("/", headers={"Host": "evil.example:80"}).status_code == 403
    foreign = {"Origin": "https://evil.example"}
    assert client.post("/audit", data=FIELDS, headers=foreign).status_code == 403
    assert client.get("/", headers={"Host": "localhost:8350"}).status_code == 200


def test_a_fault_of_ours_is_a_line_too(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "audit", Mock(side_effect=RuntimeError("unforeseen")))
    answer = client.post("/audit", data=FIELDS)
    assert answer.status_code == 500
    assert "please report" in faults(answer)["table"]


def test_a_file_that_is_too_large(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    client.application.config["MAX_CONTENT_LENGTH"] = 1000
    answer = checked(client, b"1" * 2000, motion_velocity="1")
    assert (answer.status_code, list(faults(answer))) == (413, ["motion"])


def test_only_the_last_audits_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    class Stub:
        cases = (None,)

    monkeypatch.setattr(server, "audit", lambda _: Stub)
    monkeypatch.setattr(server, "page_files", lambda *_: {"a.html": "x"})
    client = server.make_form(remembered=2).test_client()
    places = [client.post("/audit", data=FIELDS).location for _ in range(3)]
    assert [client.get(place).status_code for place in places] == [404, 200, 200]


def test_without_flask_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "flask", None)
    with pytest.raises(PackageError, match=r"trajgap app: needs the package flask .* pip install"):
        server.make_form()


def test_an_error_of_the_form_lists_its_faults() -> None:
    with pytest.raises(FormError, match="paste the way-points"):
        case_of({})


@pytest.fixture
def served() -> Iterator[str]:
    bound = make_server()
    assert bound.host == "127.0.0.1"
    thread = threading.Thread(target=bound.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{bound.port}/"
    bound.shutdown()
    thread.join()
    bound.server_close()


def test_the_guide_says_what_is_there(client: Any) -> None:
    text = client.get("/").get_data(as_text=True)
    for word in re.findall(r"\*([A-Z]\w+)\*", GUIDE):
        assert f">{word}<" in text or word == "Save", word
    _, remembered = server.make_form.__defaults__ or ()
    assert f"Up to {remembered} audits" in " ".join(GUIDE.split())
    assert server.ADDRESS in GUIDE
    assert (ROOT / "docs/pictures/form.png").is_file()


def test_a_port_that_is_taken_is_named(served: str) -> None:
    port = int(served.rpartition(":")[2].strip("/"))
    with pytest.raises(TrajgapError, match=f"--port: {port} cannot be used"):
        make_server(port)


@pytest.mark.skipif(not browser.installed(), reason="no chromedriver")
@pytest.mark.parametrize("width", [1280, 390])
def test_in_a_real_browser(width: int, served: str, tmp_path: Any) -> None:
    with browser.browser() as window:
        window.size(width, 900)
        window.open(served)
        assert window.run("document.documentElement.scrollWidth") <= width
        for name in ("table", "velocity", "durations", "where"):
            window.fill(f"#{name}", FIELDS[name] if name != "velocity" else "x")
        window.click("input[value='3-5-3']")
        window.click("form[action='/audit'] button")
        assert "not a finite decimal number" in window.text("#velocity-fault")
        assert window.run("document.querySelector('input[value=\"3-5-3\"]').checked")
        window.run("document.querySelector('#velocity').value = '2'")
        window.click("form[action='/audit'] button")
        assert "2.15 s, which breaks a limit," in window.text(".card")
        assert window.address.endswith("/audits/1/my-paper.html")
        assert window.run("document.documentElement.scrollWidth") <= width
        window.open(served)
        (tmp_path / "motion.csv").write_bytes(MOTION)
        window.fill("#motion", str(tmp_path / "motion.csv"))
        window.fill("#motion_velocity", "1")
        window.click("form[action='/check'] button")
        assert "violated" in window.text("#verdict")
        refused = [one for one in window.complaints if "422" not in one]
        assert refused == []
