"use strict";
// What the page is about. Texts that came with the bag are put on the page as text only, never as HTML.

const parsed = (id) => JSON.parse(document.getElementById(id).textContent);
const map = parsed("map");
const run = parsed("run");
const clock = parsed("clock");

const $ = (id) => document.getElementById(id);

/** An element with properties and children; strings become text. */
function make(name, properties = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key.includes("-") || key === "role") element.setAttribute(key, value);
    else element[key] = value;
  }
  element.append(...children);
  return element;
}

const chip = (label) => {
  const square = make("span", { className: "chip" });
  square.style.background = colorOf(label);
  return square;
};

const colorOf = (label) => run.colors[label] || "#999999";
const metres = (value, digits = 2) => value.toFixed(digits);
const percent = (value) => (value === null || value === undefined ? "–" : `${(100 * value).toFixed(value > 0.9995 ? 0 : 1)} %`);
const seconds = (value) => `${value.toFixed(1)} s`;
const counted = (count, one, many = `${one}s`) => `${count} ${count === 1 ? one : many}`;
/** What people call it, or its label, and its number. */
const nameOf = (object) => `${inMap.get(object.id)?.name ?? object.label} ${object.id}`;

/** Bytes of a base64 text. */
function bytesOf(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i += 1) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

/** Standard deviation of the variable `index` of rotation, translation, log semi-axes. */
const sigma = (object, index) => Math.sqrt(Math.max(object.covariance[10 * index], 0));

/** The outline's name, and its exponents if it has some. */
const outlineOf = (outline) => (typeof outline === "string" ? { kind: outline } : { kind: "superquadric", exponents: outline.superquadric });
const outlineKey = (outline) => (typeof outline === "string" ? outline : `superquadric ${outline.superquadric.join(" ")}`);

const inMap = new Map(map.objects.map((object) => [object.id, object]));
/** Places of the slider: each keyframe that is shown, and the end, after all optimisation. */
const stepCount = run.steps.length + 1;
const isEnd = (step) => step >= run.steps.length;
const stepOf = (step) => run.steps[Math.min(step, run.steps.length - 1)];
const duration = run.way.length ? run.way[run.way.length - 1][0] : 0;
const timeOf = (step) => (isEnd(step) ? duration : run.steps[step].t);

const trackList = Object.entries(run.tracks).map(([id, track]) => ({ id: Number(id), ...track }));

/** The objects as they were known at a step with the standard deviations of heading (rad), place (m) and semi-axes (share) of
 * that time. */
function objectsAt(step) {
  if (isEnd(step)) {
    return map.objects.map((object) => ({
      id: object.id, label: object.label, outline: object.outline, position: object.position,
      orientation: object.orientation, semi_axes: object.semi_axes,
      yaw_sigma: sigma(object, 2), sigmas: [3, 4, 5, 6, 7, 8].map((index) => sigma(object, index)),
    }));
  }
  const now = run.steps[step].t + 1e-6;
  const found = [];
  for (const track of trackList) {
    let low = 0;
    let high = track.states.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (track.states[middle][0] <= now) low = middle + 1; else high = middle;
    }
    const state = track.states[low - 1];
    if (!state || state.length < 8) continue;
    const [, x, y, z, yaw, a, b, c, yawSigma, ...sigmas] = state;
    found.push({
      id: track.id, label: track.label, outline: track.outline, position: [x, y, z],
      orientation: [0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)], semi_axes: [a, b, c], yaw_sigma: yawSigma, sigmas,
    });
  }
  return found;
}
