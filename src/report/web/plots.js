"use strict";
// Plots over time.

const SVG = "http://www.w3.org/2000/svg";
const PLOT = { width: 380, height: 128, left: 34, right: 8, top: 6, bottom: 18 };
/** Okabe and Ito's colours, which the colour-blind can tell apart. */
const SERIES = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#b8a800", "#7a7a7a", "#5a5fbf"];

function draw(name, attributes, parent) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  parent.append(element);
  return element;
}

/** A nice step of an axis. */
function pitch(extent) {
  const rough = extent / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= rough);
}

/** Axes; gives what takes values to pixels. */
function axes(svg, end, high) {
  const { width, height, left, right, top, bottom } = PLOT;
  const x = (t) => left + ((width - left - right) * t) / (end || 1);
  const y = (value) => height - bottom - ((height - top - bottom) * value) / (high || 1);
  const step = pitch(high || 1);
  for (let value = 0; value <= high * 1.001; value += step) {
    draw("path", { d: `M${left} ${y(value)}H${width - right}`, stroke: "var(--edge)" }, svg);
    draw("text", { x: left - 5, y: y(value) + 3, "text-anchor": "end" }, svg).textContent = String(Number(value.toPrecision(6)));
  }
  const wide = pitch(end || 1);
  for (let t = 0; t <= (end || 1) * 1.001; t += wide) {
    draw("text", { x: x(t), y: height - 5, "text-anchor": "middle" }, svg).textContent = `${Number(t.toPrecision(6))} s`;
  }
  return { x, y };
}

function plot(title, end, high, keys, paint) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", `0 0 ${PLOT.width} ${PLOT.height}`);
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", title);
  const scale = axes(svg, end, high);
  paint(svg, scale);
  const cursor = draw("path", { class: "cursor", stroke: "var(--accent)", "stroke-width": 1.2 }, svg);
  const key = make("div", { className: "key" }, ...keys.map(([name, color]) => {
    const square = make("span", { className: "chip" });
    square.style.background = color;
    return make("span", {}, square, name);
  }));
  return { parts: [make("h2", {}, title), svg, key], at: (t) => cursor.setAttribute("d", `M${scale.x(t)} ${PLOT.top}V${PLOT.height - PLOT.bottom}`) };
}

/** Bars on top of each other, one series after another. */
function stacked(title, t, series) {
  const shown = series.filter(([, values]) => values.some((value) => value > 0));
  const sums = t.map((_, i) => shown.reduce((sum, [, values]) => sum + values[i], 0));
  const end = t.length ? t[t.length - 1] : 1;
  const keys = shown.map(([name], i) => [name, SERIES[i % SERIES.length]]);
  return plot(title, end, Math.max(...sums, 1e-6), keys, (svg, { x, y }) => {
    const low = t.map(() => 0);
    shown.forEach(([, values], i) => {
      let path = "";
      values.forEach((value, at) => {
        const from = x(at ? t[at - 1] : Math.max(0, 2 * t[0] - (t[1] ?? t[0])));
        const to = Math.max(x(t[at]) - 0.4, from + 0.8);
        if (value > 0) path += `M${from.toFixed(1)} ${y(low[at]).toFixed(1)}H${to.toFixed(1)}V${y(low[at] + value).toFixed(1)}H${from.toFixed(1)}Z`;
        low[at] += value;
      });
      draw("path", { d: path, fill: SERIES[i % SERIES.length] }, svg);
    });
  });
}

function lines(title, t, series) {
  const high = Math.max(...series.flatMap(([, values]) => values.map(Math.abs)), 1e-6);
  const end = t.length ? t[t.length - 1] : 1;
  return plot(title, end, high, series.map(([name], i) => [name, SERIES[i]]), (svg, { x, y }) => {
    series.forEach(([, values], i) => {
      const path = values.map((value, at) => `${at ? "L" : "M"}${x(t[at]).toFixed(1)} ${y(Math.abs(value)).toFixed(1)}`).join("");
      draw("path", { d: path, fill: "none", stroke: SERIES[i], "stroke-width": 1.6 }, svg);
    });
  });
}

/** All plots; gives what moves their cursors. */
function showPlots() {
  const { boxes, drift } = run;
  const reasons = Object.entries(boxes.refused).map(([reason, values]) => [`refused: ${reason.replaceAll("_", " ")}`, values]);
  const all = [
    lines("Objects in the map", boxes.t, [["objects", boxes.objects]]),
    stacked("Boxes", boxes.t, [["used", boxes.used], ...reasons]),
    lines("Correction of odometry's drift", drift.t, [["place [m]", drift.metres]]),
    lines("Correction of its heading [°]", drift.t, [["heading [°]", drift.degrees]]),
    stacked("Time of a keyframe [ms]", clock.t, clock.stages.map((stage, i) => [stage.replaceAll("_", " "), clock.ms.map((at) => at[i])])),
  ];
  $("plots").replaceChildren(...all.flatMap(({ parts }) => parts));
  return (t) => all.forEach(({ at }) => at(t));
}
