"""How fluent the page is. Only measures: what is fluent enough depends on the machine."""

from playwright.sync_api import Page

SCROLLING = """
seconds => new Promise(done => {
    const end = document.documentElement.scrollHeight - innerHeight;
    let frames = 0, began;
    function frame(now) {
        began ??= now;
        const part = (now - began) / (1000 * seconds);
        if (part >= 1) return done(frames / seconds);
        frames += 1;
        scrollTo(0, part * end);
        requestAnimationFrame(frame);
    }
    requestAnimationFrame(frame);
})
"""


def scroll_frame_rate(page: Page, seconds: float = 3.0) -> float:
    """Scroll the open page from top to end within so many seconds; give the frames drawn a second."""
    rate: float = page.evaluate(SCROLLING, seconds)
    return rate
