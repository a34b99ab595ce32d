"""What `make bench-page` makes of what it measured."""

from benchmarks.page_study.loading import View, Visits
from benchmarks.page_study.page import assemble, targets
from benchmarks.page_study.study import Frames, Study

LIST = Visits(View("devices", "/devices", "a"), 172.0, 1.2, 1.4)
DEVICE = Visits(View("a device", "/devices/a", "a"), 184.0, 1.6, 1.9)
STUDY = Study([LIST, DEVICE], [Frames("scrolling", 50.0, [55.0, 47.0, 60.0]), Frames("moving", 50.0, [40.0])])


def test_the_worst_view_and_the_usual_frame_rate_decide() -> None:
    judged = {target.what: (target.measured, target.met) for target in targets(STUDY)}
    assert judged == {
        "JavaScript of any first visit": ("184 kB", True),
        "usable, slowest view (a device)": ("1.60 s", False),
        "scrolling": ("55 / 47 frames/s", True),
        "moving": ("40 / 40 frames/s", False),
    }


def test_the_section_tells_every_visit() -> None:
    text = assemble(STUDY)
    assert "| devices | 172 | 1.20 / 1.40 |" in text
    assert "| a device | 184 | 1.60 / 1.90 |" in text
    assert "with 10,000 devices" in text
