"""Uses reports as somebody would who looks at them: check.py FOLDER DEMO.html EMPTY.html [RECORDING.html ...]

Writes pictures of them into FOLDER.
"""

import json
import sys
import time
from pathlib import Path

from browser import Browser

HOSTILE = "<img src=x onerror=\"document.title='broken'\">"
# A processor draws here, and what else it does is not known: frames with 1,000 objects are compared with those of the demo.
# What a graphics card would notice is the number of draw calls, which must not grow with that of objects or walls.
LEAST_SHARE = 0.2
MOST_DRAW_CALLS = 40


def expect(holds, words):
    if not holds:
        raise SystemExit(f"report: {words}")


def data_of(page, name):
    """The data of a page and what is before and after it."""
    begin = page.index(f'id="{name}">') + len(f'id="{name}">')
    end = page.index("</script>", begin)
    return page[:begin], json.loads(page[begin:end]), page[end:]


def with_objects(page, count):
    """The same page with so many objects, all copies of its own in rows, one of them with a label that is HTML, and 100 walls."""
    before, objects, after = data_of(page, "map")
    own = objects["objects"]
    many = []
    for at in range(count):
        one = json.loads(json.dumps(own[at % len(own)]))
        one["id"] = at + 1
        row, column = divmod(at // len(own), 10)
        one["position"][0] += 4.0 * column
        one["position"][1] += 4.0 * row
        many.append(one)
    many[0]["label"], many[0]["labels"] = HOSTILE, {HOSTILE: 1.0}
    objects["objects"] = many
    page = before + json.dumps(objects).replace("<", "\\u003c") + after
    before, run, after = data_of(page, "run")
    run["tracks"] = {str(one["id"]): {"label": one["label"], "outline": one["outline"], "states": [
        [0.0, *one["position"], 0.0, *one["semi_axes"], *[0.02] * 7]]} for one in many}
    run["walls"] = [[[0.4 * at, -1.0], [0.4 * at, 3.0]] for at in range(100)]
    return before + json.dumps(run).replace("<", "\\u003c") + after


# Pixels of the scene that are not its background, read back from the graphics memory.
DRAWN = """(() => {
  view.draw();
  const gl = view.renderer.getContext();
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let drawn = 0;
  for (let i = 0; i < pixels.length; i += 4) {
    if ([0, 1, 2].some((part) => Math.abs(pixels[i + part] - pixels[part]) > 24)) drawn += 1;
  }
  return drawn / (width * height);
})()"""

# A number that another picture would hardly have.
PICTURE = """(() => {
  view.draw();
  const gl = view.renderer.getContext();
  const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return pixels.reduce((sum, part) => (31 * sum + part) % 4294967291, 7);
})()"""

FRAMES = """new Promise((done) => {
  const [began, frames] = [performance.now(), view.frames];
  const turn = () => {
    view.turn(0.03, 0);
    const passed = performance.now() - began;
    if (passed < 4000) requestAnimationFrame(turn); else done((1000 * (view.frames - frames)) / passed);
  };
  turn();
})"""


def check_looks(browser, path, folder, dark=False):
    """Loads a page; what it draws, and that nothing is complained of."""
    browser.open(path)
    if dark:
        browser.js("setTheme(true)")
    # How long the clock ran is another number each time.
    browser.js("[...$('figures').children].at(-1).hidden = Boolean(clock.mean_ms)")
    time.sleep(0.5)
    browser.picture(Path(folder, f"{Path(path).stem}.png"))
    drawn = browser.js(DRAWN)
    expect(drawn > 0.005, f"{path}: {drawn:.4f} of the scene is drawn")
    expect(not browser.problems, f"{path}: {browser.problems}")
    return drawn


# What is shown when a page opens.
STANDARD = "LAYERS.forEach(([name, , on]) => { const box = $(`layer-${name}`); if (box && box.checked !== on) box.click(); })"


def show_all(browser):
    browser.js("LAYERS.forEach(([name]) => { const box = $(`layer-${name}`); if (box && !box.checked) box.click(); })")


def check_layers(browser, path):
    """Each part of the scene that is switched off leaves other pixels."""
    show_all(browser)
    for name in ["outlines", "points", "way", "planes", "uncertainty"]:
        with_it = browser.js(PICTURE)
        browser.click_on(f"#layer-{name}")
        without = browser.js(PICTURE)
        expect(with_it != without, f"{path}: {name} shows nothing")
        browser.click_on(f"#layer-{name}")


def check_time(browser, path):
    """Slider, keys and the play button move time, and the map grows with it."""
    said = "document.getElementById('clock-time').textContent"
    at_end = browser.js("view.objects.length")
    browser.js("document.getElementById('scene').blur()")
    browser.key("Home")
    expect(browser.js("state.step") == 0, f"{path}: Home does not go to the beginning")
    expect(browser.js("view.objects.length") <= at_end, f"{path}: the map does not grow")
    first = browser.js(said)
    browser.js("document.getElementById('slider').focus()")
    browser.key("ArrowRight")
    expect(browser.js("state.step") == 1 and browser.js(said) != first, f"{path}: the slider does not move")
    browser.click_on("#play")
    begun, patience = browser.js("state.step"), time.time() + 20
    while browser.js("state.step") < begun + 3 and time.time() < patience:
        time.sleep(0.1)
    expect(browser.js("state.step") >= begun + 3, f"{path}: it does not play")
    browser.click_on("#play")
    stopped = browser.js("state.step")
    time.sleep(0.4)
    expect(browser.js("state.step") == stopped, f"{path}: it does not pause")
    browser.key("End")
    browser.js("document.activeElement.blur()")
    browser.key("End")
    expect(browser.js("view.objects.length") == at_end, f"{path}: the end is not the map")


def check_selection(browser, path):
    """An object is found by a click into the scene, in the list, by its label, and with the keyboard."""
    heading = "document.querySelector('#details h2')?.textContent"
    browser.click_on("#top")
    # Some object that no other one covers from above.
    place = browser.js("map.objects.map((o) => [o.id, ...view.place(o.id)]).find(([id, x, y]) => view.objectAt(x, y) === id)")
    left, top = browser.js("(() => { const b = $('scene').getBoundingClientRect(); return [b.x, b.y]; })()")
    browser.click(left + place[1], top + place[2])
    expect(browser.js("state.selected") == place[0], f"{path}: a click selects {browser.js('state.selected')}, not {place[0]}")
    expect(str(place[0]) in browser.js(heading), f"{path}: no details")
    size = browser.js("[...document.querySelectorAll('#details dt')].find((e) => e.textContent.startsWith('size')).nextSibling.textContent")
    own = browser.js(f"inMap.get({place[0]}).semi_axes.map((half) => (2 * half).toFixed(2))")
    expect(all(part in size for part in own), f"{path}: {size} is not {own}")
    browser.key("Home")
    expect(" at 0.0 s" in browser.js("$('known').textContent"), f"{path}: {browser.js('$(`known`).textContent')} is not what was known at first")
    browser.key("End")
    browser.key("Escape")
    expect(browser.js("state.selected") is None, f"{path}: Escape selects nothing")
    browser.click_on("#list li")
    expect(browser.js("state.selected") is not None, f"{path}: the list does not select")
    browser.key("n")
    second = browser.js("state.selected")
    browser.key("n")
    alone = browser.js("map.objects.length") == 1
    expect(alone or browser.js("state.selected") != second, f"{path}: N does not go on")
    label = browser.js("map.objects[map.objects.length - 1].label")
    browser.key("/")
    browser.type(label[:4])
    shown = browser.js("[...document.querySelectorAll('#list li')].map((li) => li.children[1].textContent)")
    expect(shown and all(label[:4] in name for name in shown), f"{path}: {label[:4]} finds {shown}")
    browser.key("Enter")
    expect(label[:4] in browser.js(heading), f"{path}: Enter does not select what was found")
    browser.js("$('search').value = ''; list(); $('search').blur()")


def check_keyboard(browser, path):
    """Everything can be reached with the Tab key; the view turns and zooms."""
    wanted = {"scene", "theme", "fit", "search", "slider", "play", "tab-objects", "layer-points"}
    browser.js("document.activeElement.blur(); document.body.focus()")
    for _ in range(80):
        browser.key("Tab")
        wanted.discard(browser.js("document.activeElement.id"))
    expect(not wanted, f"{path}: Tab does not reach {wanted}")
    eye = "view.camera.position.toArray().join()"
    browser.js("$('scene').focus()")
    for key in ["ArrowLeft", "ArrowUp", "+"]:
        before = browser.js(eye)
        browser.key(key)
        expect(browser.js(eye) != before, f"{path}: {key} does not move the view")
    before = browser.js(eye)
    browser.drag((500, 400), (620, 430))
    expect(browser.js(eye) != before, f"{path}: the mouse does not turn the view")
    for name in ["plots", "truth", "notes", "objects"]:
        browser.js(f"$('tab-{name}').hidden || $('tab-{name}').click()")
    theme = browser.js("document.documentElement.dataset.theme")
    browser.key("d")
    expect(browser.js("document.documentElement.dataset.theme") != theme, f"{path}: D does not change the theme")
    browser.key("d")


def check_many(browser, path, usual):
    shown = browser.js("document.querySelector('#list li').children[1].textContent")
    expect(shown == f"{HOSTILE} 1", f"{path}: a label became {shown}")
    browser.js("select(1)")
    expect(HOSTILE in browser.js("document.querySelector('#details').textContent"), f"{path}: the details changed a label")
    expect(browser.js("document.querySelectorAll('img[src=x]').length") == 0, f"{path}: a label became HTML")
    expect(browser.js("document.title") != "broken", f"{path}: a label ran")
    show_all(browser)
    browser.js("view.draw()")
    calls = browser.js("view.drawCalls")
    expect(calls <= MOST_DRAW_CALLS, f"{path}: {calls} draw calls a frame")
    count = browser.js("map.objects.length")
    browser.js(STANDARD)
    frames = browser.js(FRAMES)
    print(f"report: {frames:.1f} frames a second with {count} objects drawn by the processor, {usual:.1f} with the demo's; {calls} draw calls with all layers")
    expect(frames >= LEAST_SHARE * usual, f"{path}: {frames:.1f} frames a second are too few beside {usual:.1f}")


def main():
    folder, demo, empty, *recordings = sys.argv[1:]
    Path(folder).mkdir(parents=True, exist_ok=True)
    many = Path(folder, "many.html")
    many.write_text(with_objects(Path(demo).read_text(), 1000))
    with Browser() as browser:
        for path in [demo, *recordings]:
            drawn = check_looks(browser, path, folder)
            check_layers(browser, path)
            check_time(browser, path)
            check_selection(browser, path)
            check_keyboard(browser, path)
            expect(not browser.problems, f"{path}: {browser.problems}")
            print(f"report: {path} works; {drawn:.2f} of the scene is drawn")
        browser.open(demo)
        usual = browser.js(FRAMES)
        check_looks(browser, empty, folder)
        expect(browser.js("map.objects.length") == 0, f"{empty}: it is not empty")
        check_time(browser, empty)
        check_looks(browser, many, folder, dark=True)
        check_many(browser, many, usual)
        expect(not browser.problems, f"{many}: {browser.problems}")


main()
