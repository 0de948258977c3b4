"""Makes the pictures of docs/figures.md from reports: figures.py FOLDER RECORDING.html FORWARD.html"""

import base64
import sys
from pathlib import Path

from browser import Browser

folder, recording, forward = sys.argv[1:]


def view(browser, name):
    """The scene alone."""
    box = browser.js("(() => { const b = $('scene').getBoundingClientRect(); return { x: b.x, y: b.y, width: b.width, height: b.height, scale: 1 }; })()")
    browser.js("['layers', 'views'].forEach((id) => { $(id).style.display = 'none'; })")
    browser.js("new Promise((done) => { view.draw(); requestAnimationFrame(() => requestAnimationFrame(done)); })")
    shot = browser.call("Page.captureScreenshot", format="png", clip=box)
    Path(folder, name).write_bytes(base64.b64decode(shot["data"]))


def image(browser, name):
    """The image of the time with its boxes and outlines."""
    data = browser.js("new Promise((done) => setTimeout(() => done($('image').toDataURL('image/png')), 300))")
    Path(folder, name).write_bytes(base64.b64decode(data.split(",")[1]))


with Browser() as browser:
    browser.open(recording)
    browser.js("['odometry'].forEach((name) => $(`layer-${name}`).click())")
    for number, share in enumerate([0.1, 0.5, 1.0]):
        browser.js(f"setStep(Math.round({share} * (stepCount - 2)))")
        image(browser, f"process_image_{number}.png")
        view(browser, f"process_view_{number}.png")
    browser.open(forward)
    browser.js("['walls', 'points', 'camera', 'odometry'].forEach((name) => { const box = $(`layer-${name}`); if (box?.checked) box.click(); })")
    browser.js("$('layer-truth').click(); view.fit(true)")
    view(browser, "forward.png")
