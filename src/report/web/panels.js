"use strict";
// The image of a time, the list of objects, what is known of one, the truth, and notes on the run.

const FACES = ["left (−x)", "right (+x)", "rear (−y)", "front (+y)", "lower (−z)", "upper (+z)"];
const FACE_NAMES = ["−x", "+x", "−y", "+y", "bottom", "top"];
const KINDS = ["seen", "stands on", "mirrored", "box says", "cut", "hidden"];

/** Rows of a definition list. */
const rows = (pairs) => make("dl", {}, ...pairs.flatMap(([term, value]) => [make("dt", {}, term), make("dd", {}, value)]));

// --- the image

const picture = new Image();
let pictured = 0;

function drawImage(step, selected) {
  const at = stepOf(step);
  const canvas = $("image");
  const pen = canvas.getContext("2d");
  const [width, height] = at ? at.size : [4, 3];
  canvas.width = 2 * canvas.clientWidth;
  canvas.height = Math.round((canvas.width * height) / width);
  const scale = canvas.width / width;
  const paint = () => {
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    if (at?.jpeg && picture.complete && picture.naturalWidth) pen.drawImage(picture, 0, 0, canvas.width, canvas.height);
    if (at) drawOver(pen, at, scale, selected);
  };
  const source = at?.jpeg ? `data:image/jpeg;base64,${at.jpeg}` : "";
  pictured += 1;
  const mine = pictured;
  if (source && picture.dataset.step !== String(run.steps.indexOf(at))) {
    picture.dataset.step = String(run.steps.indexOf(at));
    picture.onload = () => { if (mine === pictured) paint(); };
    picture.onerror = () => { if (mine === pictured) $("caption").firstChild.textContent = "the colour image does not decode; boxes and outlines"; };
    picture.src = source;
  }
  paint();
  const labels = new Map([...trackList, ...map.objects].map((object) => [object.id, object.label]));
  canvas.setAttribute("aria-label", at ? `${counted(at.boxes.length, "box", "boxes")} of the detector` : "no image");
  $("caption").replaceChildren(
    make("span", {}, at ? (at.jpeg ? "colour image, boxes, outlines of objects" : "no colour image; boxes and outlines") : "no keyframe"),
    make("span", {}, isEnd(step) ? "after all optimisation" : ""),
  );
  listBoxes(at, labels);
}

function drawOver(pen, at, scale, selected) {
  pen.lineJoin = "round";
  const labels = new Map(trackList.map((track) => [track.id, track.label]));
  for (const object of map.objects) labels.set(object.id, object.label);
  for (const [id, lines] of at.outlines) {
    pen.strokeStyle = colorOf(labels.get(id));
    pen.lineWidth = id === selected ? 5 : 2.5;
    pen.beginPath();
    for (let i = 0; i + 3 < lines.length; i += 4) {
      pen.moveTo(lines[i] * scale, lines[i + 1] * scale);
      pen.lineTo(lines[i + 2] * scale, lines[i + 3] * scale);
    }
    pen.stroke();
  }
  pen.font = `600 ${Math.round(pen.canvas.width / 46)}px system-ui, sans-serif`;
  const line = Math.round(pen.canvas.width / 38);
  for (const box of at.boxes) {
    const [left, top, right, low] = box.rect.map((value) => value * scale);
    pen.setLineDash(box.refused ? [7, 6] : []);
    pen.strokeStyle = box.refused ? "#e8e8e8" : colorOf(box.label);
    pen.lineWidth = 1.5;
    pen.strokeRect(left, top, right - left, low - top);
    pen.setLineDash([]);
    const text = box.refused ? `${box.label} ✕` : box.label;
    const width = pen.measureText(text).width + 8;
    const y = Math.max(top - line, 0);
    pen.fillStyle = "rgba(10, 14, 20, .72)";
    pen.fillRect(left, y, width, line);
    pen.fillStyle = box.refused ? "#d5d5d5" : "#ffffff";
    pen.fillText(text, left + 4, y + 0.76 * line);
  }
}

function listBoxes(at, labels) {
  const boxes = at ? at.boxes : [];
  const refused = boxes.filter((box) => box.refused);
  $("boxes").querySelector("summary").textContent = `${counted(boxes.length, "box", "boxes")}, ${refused.length} refused`;
  const items = [...refused, ...boxes.filter((box) => !box.refused)].map((box) => {
    const object = box.object === null ? "no object yet" : `object ${box.object}${labels.has(box.object) ? ` (${labels.get(box.object)})` : ""}`;
    const words = box.refused ? `refused: ${box.refused}${box.object === null ? "" : `; a glimpse of ${object}`}` : object;
    return make("li", {}, make("b", {}, box.label), ` ${box.probability.toFixed(2)} · ${words}`);
  });
  $("boxes").querySelector("ul").replaceChildren(...items);
}

// --- the list of objects

/** What the list has; it is made anew only when that changes, which it does not while time passes. */
let listed = "";

function listObjects(present, selected, wanted, onSelect) {
  const there = new Set(present.map((object) => object.id));
  const all = [...map.objects, ...present.filter((object) => !inMap.has(object.id))];
  const matching = all.filter((object) => nameOf(object).toLowerCase().includes(wanted.toLowerCase()));
  const ids = matching.map((object) => object.id);
  const names = matching.map(nameOf).join("\n");
  if (names !== listed || !names) {
    listed = names;
    const nothing = all.length ? "no object is called so" : "the map has no objects";
    const items = matching.map((object) => listItem(object, onSelect));
    $("list").replaceChildren(...(items.length ? items : [make("li", { className: "soft" }, "", nothing)]));
  }
  const reached = ids.includes(selected) ? selected : ids[0];
  matching.forEach((object, at) => {
    const item = $("list").children[at];
    item.setAttribute("aria-selected", String(object.id === selected));
    item.tabIndex = object.id === reached ? 0 : -1;
    item.className = there.has(object.id) ? "" : "later";
  });
  return ids;
}

function listItem(object, onSelect) {
  const item = make("li", { role: "option" }, chip(object.label), make("span", {}, nameOf(object)),
    make("span", { className: "soft" }, object.semi_axes.map((half) => metres(2 * half)).join(" × ")));
  item.dataset.id = object.id;
  item.addEventListener("click", () => onSelect(object.id));
  return item;
}

// --- one object

/** Where the selected object was at a step, how large, and how sure that was then. */
function showKnown(id, objects, step) {
  const panel = $("known");
  if (!panel) return;
  const then = objects.find((object) => object.id === id);
  const when = seconds(timeOf(step));
  if (!then) {
    panel.replaceChildren(make("p", { className: "soft" }, `Not in the map at ${when}.`));
    return;
  }
  const size = then.semi_axes.map((half, axis) => `${metres(2 * half)} ± ${metres(2 * half * then.sigmas[3 + axis])}`).join(" × ");
  const place = then.position.map((value, axis) => `${metres(value)} ± ${metres(then.sigmas[axis])}`).join(", ");
  const yaw = 2 * Math.atan2(then.orientation[2], then.orientation[3]) * (180 / Math.PI);
  panel.replaceChildren(
    rows([["size [m]", size], ["position [m]", place], ["heading", `${yaw.toFixed(1)} ± ${(then.yaw_sigma * (180 / Math.PI)).toFixed(1)} °`]]),
    ...(isEnd(step) ? [] : [make("p", { className: "soft" }, `As known at ${when}; below, at the end.`)]),
  );
}

function showDetails(id, onClose, onTime) {
  const panel = $("details");
  const object = inMap.get(id);
  panel.hidden = id === null;
  if (id === null) return;
  const close = make("button", { type: "button", "aria-label": "Close" }, "×");
  close.addEventListener("click", onClose);
  if (!object) {
    const track = trackList.find((one) => one.id === id);
    panel.replaceChildren(make("h2", {}, chip(track.label), nameOf(track), close), make("p", { className: "soft" }, "It is not in the map at the end: it went, or it became one with another object."));
    return;
  }
  const since = (stamp) => seconds(stamp - run.start);
  const { kind, exponents } = outlineOf(object.outline);
  panel.replaceChildren(
    make("h2", {}, chip(object.label), nameOf(object), close),
    make("div", { id: "known" }),
    rows([
      ["stands at", object.support_height === null || object.support_height === undefined ? "not seen" : `${metres(object.support_height)} m`],
      ["outline", exponents ? `${kind} ${exponents.join(", ")}` : kind],
      ["existence", percent(object.existence)],
      ["observations", String(object.observations)],
      ["seen", `${since(object.first_seen)} to ${since(object.last_seen)}`],
    ]),
    beliefs(object),
    ...(run.sides[id] ? [faces(run.sides[id])] : []),
    crops(id, onTime),
  );
}

function beliefs(object) {
  const shown = Object.entries(object.labels).filter(([, p]) => p >= 0.005).sort((a, b) => b[1] - a[1]).slice(0, 6);
  const parts = shown.flatMap(([label, p]) => {
    const bar = make("i");
    bar.style.width = `${100 * p}%`;
    bar.style.background = colorOf(label);
    return [make("span", {}, label), make("span", {}, bar), make("span", { className: "soft" }, percent(p))];
  });
  return make("div", { className: "bars" }, ...parts);
}

/** How often each face was seen, or how else it is known. */
function faces(counts) {
  const used = KINDS.map((_, kind) => counts.some((face) => face[kind] > 0));
  const head = make("tr", {}, make("th", {}, "face"), ...KINDS.filter((_, kind) => used[kind]).map((name) => make("th", {}, name)));
  const body = counts.map((face, at) => {
    const most = Math.max(...face);
    const cells = face.filter((_, kind) => used[kind]).map((count) => make("td", { className: count === most && most > 0 ? "most" : "soft" }, count ? String(count) : "·"));
    return make("tr", { title: FACES[at] }, make("td", {}, FACE_NAMES[at]), ...cells);
  });
  return make("table", { className: "faces" }, head, ...body);
}

function crops(id, onTime) {
  const all = run.crops[id] || [];
  if (!all.length) return make("p", { className: "soft" }, "No colour image of it was kept.");
  return make("div", { className: "crops" }, ...all.map((crop) => {
    const image = make("img", { src: `data:image/jpeg;base64,${crop.jpeg}`, alt: `at ${seconds(crop.t)}` });
    const button = make("button", { type: "button", title: `at ${seconds(crop.t)}` }, image);
    button.addEventListener("click", () => onTime(crop.t));
    return button;
  }));
}

// --- the truth

function showTruth() {
  const panel = $("truth");
  if (!run.truth) {
    panel.replaceChildren(make("p", { className: "soft" }, "The truth is not known: neither --ground-truth nor topics under /ground_truth/ gave it."));
    return;
  }
  const { scores, trajectory, source } = run.truth;
  const cell = (value, digits = 3) => (value === null || value === undefined ? "–" : value.toFixed(digits));
  const parts = [
    make("h2", {}, "Objects"),
    rows([
      ["found", `${scores.matches.length} of ${scores.true_objects} (recall ${percent(scores.recall)})`],
      ["precision", percent(scores.precision)],
      ["right label", percent(scores.label_agreement)],
      ["seen twice", String(scores.duplicates)],
    ]),
    scoreTable(scores, cell),
  ];
  if (scores.missed.length) parts.push(make("p", { className: "soft" }, `Missed: ${scores.missed.map((one) => `${one.true_label} ${one.true_id}`).join(", ")}`));
  if (trajectory) {
    const line = (name, of) => make("tr", {}, make("td", {}, name), ...["rmse", "mean", "median", "max"].map((key) => make("td", {}, cell(of[key], 4))));
    parts.push(make("h2", {}, `Way of the base (${trajectory.poses} poses)`), make("table", { className: "scores" },
      make("tr", {}, ...["", "rmse", "mean", "median", "max"].map((name) => make("th", {}, name))),
      line("ATE [m]", trajectory.ate_m), line("aligned [m]", trajectory.aligned_ate_m), line("RPE [m]", trajectory.rpe_m), line("RPE [°]", trajectory.rpe_deg)));
  }
  parts.push(make("p", { className: "soft" }, `As eval measures; truth from ${source}.`));
  panel.replaceChildren(...parts);
}

/** A line an object that was found. */
function scoreTable(scores, cell) {
  const head = make("tr", {}, ...["object", "centre [m]", "turn [°]", "IoU"].map((name) => make("th", {}, name)));
  const lines = scores.matches.map((match) => make("tr", {}, make("td", {}, `${match.label} ${match.id}`),
    make("td", {}, cell(match.translation_m)), make("td", {}, cell(match.rotation_deg, 1)), make("td", {}, cell(match.iou, 2))));
  return make("table", { className: "scores" }, head, ...lines);
}

// --- the run

function showNotes() {
  const panel = $("notes");
  const list = (items) => make("ul", {}, ...items.map((item) => make("li", {}, item)));
  const used = Object.entries(run.summary.topics || {}).filter(([, topic]) => topic && topic.length);
  panel.replaceChildren(
    make("h2", {}, "What this page has"), list(run.notes),
    ...(run.warnings.length ? [make("h2", { className: "warn" }, "Warnings"), list(run.warnings)] : []),
    make("h2", {}, "Topics"), rows(used.map(([role, topic]) => [role, String(topic)])),
    make("h2", {}, "Counts"), rows([
      ["RGB-D frames", String(run.summary.frames)], ["keyframes", String(run.summary.keyframes)],
      ["boxes", String(run.summary.boxes)], ["frame of the map", map.frame_id],
      ["time", clock.seconds ? seconds(clock.seconds) : "–"], ["memory at the peak", clock.peak_memory_mb ? `${clock.peak_memory_mb.toFixed(0)} MB` : "–"],
    ]),
    make("p", { className: "soft" }, "Drawn with three.js, © three.js authors, MIT licence; the text of the licence is in this file."),
  );
}
