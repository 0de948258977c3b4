"use strict";
// What happens when something is touched.

const LAYERS = [
  ["outlines", "Objects", true], ["names", "Names", true], ["boxes", "Boxes round them", false], ["uncertainty", "Uncertainty (2 σ)", false],
  ["points", "Points", true], ["planes", "Support planes", false], ["walls", "Walls", true], ["way", "Way, optimised", true, "#0f8fd6"],
  ["odometry", "Way by odometry", true, "#d55e00"], ["camera", "Camera", true, "#e69f00"], ["truth", "Truth", false, "var(--text)"],
];
const KEYS = [
  ["Space", "play, pause"], ["← →", "earlier, later (anywhere but in the map)"], ["Home End", "begin, end"], ["/", "search labels"],
  ["↑ ↓", "in the list: another object"], ["N, Shift+N", "next, previous object"], ["Esc", "select nothing"], ["1 … 0, -", "switch what is shown"],
  ["F T C", "all of the map, from above, through the camera"], ["D", "light or dark"], ["In the map", "arrows turn, + and - zoom"],
];

const state = { step: stepCount - 1, selected: null, matching: [], playing: null };
let view = null;
let moveCursors = () => {};

function setTheme(dark) {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  $("theme").textContent = dark ? "Light" : "Dark";
  view?.theme(dark);
  drawSpark();
}

function setStep(step) {
  state.step = Math.max(0, Math.min(step, stepCount - 1));
  const objects = objectsAt(state.step);
  $("slider").value = state.step;
  const t = timeOf(state.step);
  $("clock-time").textContent = isEnd(state.step) ? `end · ${counted(objects.length, "object")}` : `${seconds(t)} of ${seconds(duration)} · ${objects.length}`;
  $("slider").setAttribute("aria-valuetext", $("clock-time").textContent);
  view?.setStep(objects, state.step);
  drawImage(state.step, state.selected);
  moveCursors(t);
  showKnown(state.selected, objects, state.step);
  list(objects);
}

function list(objects = objectsAt(state.step)) {
  state.matching = listObjects(objects, state.selected, $("search").value, select);
}

function select(id) {
  state.selected = id;
  view?.select(id);
  showDetails(id, () => select(null), toTime);
  showKnown(id, objectsAt(state.step), state.step);
  drawImage(state.step, id);
  list();
  if (id !== null) {
    openTab("objects");
    $("list").querySelector(`[data-id="${id}"]`)?.scrollIntoView({ block: "nearest" });
    $("objects").scrollTop = 0;
  }
}

/** The step nearest to a time. */
function toTime(t) {
  let best = 0;
  run.steps.forEach((step, at) => { if (Math.abs(step.t - t) < Math.abs(run.steps[best].t - t)) best = at; });
  setStep(best);
}

function selectNext(by) {
  if (!state.matching.length) return;
  const at = state.matching.indexOf(state.selected);
  const next = at < 0 ? (by > 0 ? 0 : -1) : at + by;
  select(state.matching.at(next % state.matching.length));
}

function play(on = !state.playing) {
  clearTimeout(state.playing);
  state.playing = null;
  $("play").textContent = on ? "Pause" : "Play";
  $("play").setAttribute("aria-pressed", String(on));
  if (!on) return;
  if (isEnd(state.step)) setStep(0);
  // All of it in about twenty seconds, or as it was where that is shorter.
  const pace = Math.max(1, duration / 20);
  const advance = () => {
    setStep(state.step + 1);
    if (isEnd(state.step)) { play(false); return; }
    state.playing = setTimeout(advance, Math.max(30, (1000 * (timeOf(state.step + 1) - timeOf(state.step))) / pace));
  };
  state.playing = setTimeout(advance, 60);
}

function openTab(name) {
  for (const tab of document.querySelectorAll("[role=tab]")) {
    const is = tab.id === `tab-${name}`;
    tab.setAttribute("aria-selected", String(is));
    tab.tabIndex = is ? 0 : -1;
    $(tab.getAttribute("aria-controls")).hidden = !is;
  }
}

/** How many objects there were, behind the slider. */
function drawSpark() {
  const canvas = $("spark");
  canvas.width = 2 * canvas.clientWidth;
  canvas.height = 2 * canvas.clientHeight;
  const pen = canvas.getContext("2d");
  const { t, objects } = run.boxes;
  const high = Math.max(...objects, 1);
  pen.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--shade");
  pen.beginPath();
  pen.moveTo(0, canvas.height);
  let before = 0;
  t.forEach((time, i) => {
    const x = (canvas.width * time) / (duration || 1);
    pen.lineTo(x, canvas.height * (1 - before / high));
    pen.lineTo(x, canvas.height * (1 - objects[i] / high));
    before = objects[i];
  });
  pen.lineTo(canvas.width, canvas.height * (1 - before / high));
  pen.lineTo(canvas.width, canvas.height);
  pen.fill();
}

function addLayers() {
  const has = { truth: run.truth, walls: run.walls.length, points: run.points.count };
  LAYERS.forEach(([name, words, on, color], at) => {
    if (name in has && !has[name]) return;
    const input = make("input", { type: "checkbox", checked: on, id: `layer-${name}` });
    const show = () => { if (name === "camera") view.hidesCamera = !input.checked; view.show(name, input.checked); };
    input.addEventListener("change", show);
    const label = make("label", { title: `${"1234567890-"[at]}` }, input, make("span", {}, words));
    if (color) {
      const mark = make("i");
      mark.style.background = color;
      label.append(mark);
    }
    $("layers").append(label);
    show();
  });
}

function listen() {
  $("slider").max = stepCount - 1;
  $("slider").addEventListener("input", (event) => { play(false); setStep(Number(event.target.value)); });
  $("play").addEventListener("click", () => play());
  $("search").addEventListener("input", () => list());
  $("search").addEventListener("keydown", (event) => { if (event.key === "Enter" && state.matching.length) select(state.matching[0]); });
  $("theme").addEventListener("click", () => setTheme(document.documentElement.dataset.theme !== "dark"));
  $("keys").addEventListener("click", () => $("help").showModal());
  $("fit").addEventListener("click", () => view?.fit());
  $("top").addEventListener("click", () => view?.fit(true));
  $("follow").addEventListener("click", () => view?.setFollow(!view.follows));
  document.querySelectorAll("[role=tab]").forEach((tab) => tab.addEventListener("click", () => openTab(tab.id.slice(4))));
  $("help").querySelector("dl").append(...KEYS.flatMap(([key, words]) => [make("dt", {}, make("kbd", {}, key)), make("dd", {}, words)]));
  document.addEventListener("keydown", onKey);
  window.addEventListener("resize", () => { drawImage(state.step, state.selected); drawSpark(); });
  let pressed = null;
  $("scene").addEventListener("pointermove", (event) => {
    if (event.buttons) return;
    const { left, top } = $("scene").getBoundingClientRect();
    view?.pointAt(event.clientX - left, event.clientY - top);
  });
  $("scene").addEventListener("pointerleave", () => view?.pointAt());
  $("scene").addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
  $("scene").addEventListener("pointerup", (event) => {
    if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
    const { left, top } = $("scene").getBoundingClientRect();
    select(view.objectAt(event.clientX - left, event.clientY - top));
  });
}

const AT_MAP = {
  ArrowLeft: () => view?.turn(-0.12, 0), ArrowRight: () => view?.turn(0.12, 0), ArrowUp: () => view?.turn(0, 0.08), ArrowDown: () => view?.turn(0, -0.08),
  "+": () => view?.turn(0, 0, 1.2), "=": () => view?.turn(0, 0, 1.2), "-": () => view?.turn(0, 0, 1 / 1.2),
};
const IN_LIST = { ArrowDown: () => selectNext(1), ArrowUp: () => selectNext(-1) };
const IN_TABS = { ArrowRight: () => stepTab(1), ArrowLeft: () => stepTab(-1) };
const ANYWHERE = {
  " ": () => play(), ArrowLeft: () => setStep(state.step - 1), ArrowRight: () => setStep(state.step + 1), Home: () => setStep(0), End: () => setStep(stepCount - 1),
  "/": () => { openTab("objects"); $("search").focus(); }, n: () => selectNext(1), N: () => selectNext(-1), Escape: () => select(null), "?": () => $("help").showModal(),
  f: () => view?.fit(), t: () => view?.fit(true), c: () => view?.setFollow(!view.follows), d: () => $("theme").click(),
};

function stepTab(by) {
  const tabs = [...document.querySelectorAll("[role=tab]")];
  const next = tabs.at((tabs.findIndex((tab) => tab.getAttribute("aria-selected") === "true") + by) % tabs.length);
  openTab(next.id.slice(4));
  next.focus();
}

function onKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || $("help").open) return;
  const { key, target } = event;
  if (target.matches("input[type=search]") && key !== "Escape") return;
  if (target.matches("button, summary, input[type=checkbox]") && key === " ") return;
  if (target.matches("input[type=range]") && ["ArrowLeft", "ArrowRight", "Home", "End"].includes(key)) return;
  const layer = LAYERS["1234567890-".indexOf(key)];
  const own = (target.id === "scene" && AT_MAP[key]) || (target.closest("#list") && IN_LIST[key]) || (target.matches("[role=tab]") && IN_TABS[key]);
  const act = own || ANYWHERE[key] || (layer && (() => $(`layer-${layer[0]}`)?.click()));
  if (!act) return;
  event.preventDefault();
  act();
  if (own === IN_LIST[key] && own) $("list").querySelector("[aria-selected=true]")?.focus();
}

function begin() {
  document.title = `${run.title} · ellipsoid_slam`;
  $("title").textContent = run.title;
  const figure = (value, words) => make("span", {}, make("b", {}, String(value)), ` ${words}`);
  $("figures").append(
    figure(map.objects.length, map.objects.length === 1 ? "object" : "objects"), figure(run.summary.keyframes, "keyframes"), figure(seconds(duration), "drive"),
    figure(run.summary.boxes, "boxes"), ...(clock.mean_ms ? [figure(clock.mean_ms.toFixed(1), "ms a keyframe")] : []),
  );
  const trouble = (words) => { $("trouble").textContent = words; $("trouble").hidden = false; };
  try {
    view = new View($("scene"), $("names"));
    view.onFollow = (follows) => $("follow").setAttribute("aria-pressed", String(follows));
  } catch (problem) {
    trouble(`This browser does not draw in three dimensions (${problem.message}). Everything else on the page works.`);
  }
  if (view) addLayers();
  if (!map.objects.length) trouble("The map has no objects.");
  moveCursors = showPlots();
  showTruth();
  showNotes();
  if (!run.truth) $("tab-truth").hidden = true;
  openTab("objects");
  listen();
  setTheme(window.matchMedia("(prefers-color-scheme: dark)").matches);
  setStep(stepCount - 1);
}

begin();
