"use strict";
// The page of `kinora preview`. It asks for the next picture, shows it, and sends commands. All state is the session's.

const $ = (id) => document.getElementById(id);
const page = Array.from(crypto.getRandomValues(new Uint8Array(8)), (b) => b.toString(16).padStart(2, "0")).join("");
const canvas = $("picture");
const context = canvas.getContext("2d");

let state = {};
let info = { generation: -1 };
let asking = false;
let bitmap = null;
let reference = null;
let isSplit = false;
let range = null; // The looped range of frames, or null for all.
let owned = false;

// ---- Server ----

async function post(path, body) {
  const options = { method: "POST" };
  if (body) options.body = JSON.stringify(body);
  const answer = await fetch(`${path}?page=${page}`, options);
  if (answer.status === 409) return lose();
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer.json();
}

/** Sends a command and returns its answer; errors are shown. */
async function send(command) {
  try {
    const answer = await post("do", command);
    if (answer && answer.error) toast(answer.error);
    return answer;
  } catch (error) {
    toast(String(error.message || error));
    return null;
  }
}

function lose() {
  owned = false;
  $("elsewhere").hidden = false;
  $("take-over").focus();
  return null;
}

async function own() {
  await post("own");
  owned = true;
  $("elsewhere").hidden = true;
  listen();
}

/** Asks for the next picture, again and again. */
async function listen() {
  let after = 0;
  while (owned) {
    try {
      const answer = await fetch(`next?page=${page}&after=${after}`);
      if (answer.status === 409) { lose(); return; }
      if (answer.status === 204) continue;
      if (!answer.ok) throw new Error(answer.statusText);
      const bytes = await answer.arrayBuffer();
      const length = new DataView(bytes).getUint32(0, true);
      const next = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
      const png = bytes.byteLength > 4 + length
        ? await createImageBitmap(new Blob([new Uint8Array(bytes, 4 + length)], { type: "image/png" }))
        : null;
      after = next.number;
      show(next, png);
    } catch (error) {
      setStatus("The preview has ended or cannot be reached.", true);
      await new Promise((resolve) => setTimeout(resolve, 700));
      after = 0;
    }
  }
}

// ---- Picture and state ----

function show(next, png) {
  state = next;
  if (state.frame === wanted || state.playing) wanted = null;
  if (png) {
    if (bitmap && bitmap !== reference) bitmap.close();
    bitmap = png;
    $("empty").hidden = true;
  }
  paint();
  describe();
  if (state.generation !== info.generation && !asking) loadInfo();
}

function paint() {
  if (!bitmap || !state.size) return;
  const [width, height] = state.size;
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  fit();
  context.clearRect(0, 0, width, height);
  draw(bitmap, width, height);
  if (isSplit && reference) {
    const at = Math.round(width * $("split").value / 100);
    context.save();
    context.beginPath();
    context.rect(0, 0, at, height);
    context.clip();
    context.clearRect(0, 0, at, height);
    draw(reference, width, height);
    context.restore();
  }
  placeOverlays();
}

/** Draws a picture that may be coarser than the canvas. Its pixels are whole cells. */
function draw(image, width, height) {
  const cell = Math.max(1, Math.ceil(width / image.width));
  context.imageSmoothingEnabled = !state.heat;
  const exact = image.width * cell >= width && image.width * cell < width + cell && cell <= 8;
  if (exact) context.drawImage(image, 0, 0, image.width * cell, image.height * cell);
  else context.drawImage(image, 0, 0, width, height);
}

/** Shows the picture as large as the room allows. Small ones grow by at most two. */
function fit() {
  const box = $("frame-box").getBoundingClientRect();
  const [width, height] = state.size;
  const scale = Math.min(box.width / width, box.height / height, 2);
  canvas.style.width = `${Math.max(1, Math.floor(width * scale))}px`;
  canvas.style.height = `${Math.max(1, Math.floor(height * scale))}px`;
}

function placeOverlays() {
  const box = $("frame-box").getBoundingClientRect(), at = canvas.getBoundingClientRect();
  const line = $("split-line");
  line.hidden = !(isSplit && reference);
  line.style.left = `${at.left - box.left + at.width * $("split").value / 100 - 1}px`;
  line.style.top = `${at.top - box.top}px`;
  line.style.height = `${at.height}px`;
  const marker = $("marker");
  marker.hidden = !picked || !state.size;
  if (picked && state.size) {
    marker.style.left = `${at.left - box.left + (picked.x + 0.5) / state.size[0] * at.width}px`;
    marker.style.top = `${at.top - box.top + (picked.y + 0.5) / state.size[1] * at.height}px`;
  }
}

function setStatus(text, bad) {
  $("status").textContent = text;
  $("status").classList.toggle("bad", Boolean(bad));
}

const digits = (value, count = 3) => Number(value).toPrecision(count).replace(/\.?0+$/, "");
const percent = (value) => `${100 * value >= 99.5 ? Math.round(100 * value) : digits(100 * value, 2)} %`;

/** A time for people. */
function duration(seconds) {
  if (seconds < 1) return `${Math.max(1, Math.round(seconds * 1000))} ms`;
  if (seconds < 90) return `${digits(seconds, 2)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${digits(seconds / 3600, 2)} h`;
}

function list(element, entries) {
  element.replaceChildren(...entries.flatMap(([name, value]) => {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = name;
    if (value instanceof Node) dd.append(value); else dd.textContent = value;
    return [dt, dd];
  }));
}

function isDone() {
  const reached = state.target && state.error != null && state.error <= state.target;
  return state.stride === 1 && (state.samples >= state.most || reached);
}

/** Shows messages: help breaks at the margin, but columns of the file's text must stay below each other. */
function showMessages(text) {
  $("messages").replaceChildren(...text.split(/(?<=\n)/).map((line) => {
    const part = document.createElement("span");
    part.textContent = line;
    if (/^ *= help: /.test(line) || /^(error|warning): /.test(line)) part.className = "wraps";
    return part;
  }));
}

function describe() {
  const bad = Boolean(state.diagnostics);
  if ($("diagnostics").hidden === bad) {
    $("diagnostics").hidden = !bad;
    $("stage").classList.toggle("beside", bad);
    paint();
  }
  if (bad && $("messages").textContent !== state.diagnostics) showMessages(state.diagnostics);
  if (!bad) $("messages").textContent = "";
  if (!state.size) { setStatus(bad ? "No picture yet" : "Loading …", bad); if (bad) $("empty").hidden = true; return; }

  const what = state.stride > 1 ? `every ${state.stride === 2 ? "second" : "fourth"} pixel` : `${state.samples} of ${state.most}`;
  const rows = [
    ["Samples", state.stride > 1 ? what : `${what}${state.random ? "" : " (grid)"}`],
    ["Size", `${state.size[0]} × ${state.size[1]}${state.reduced > 1 ? ` (1/${state.reduced})` : ""}`],
  ];
  if (state.random) {
    const target = state.target ? `, target ${percent(state.target)}` : "";
    rows.push(["Error", (state.error == null ? "not yet known" : `about ${percent(state.error)}`) + target]);
  } else rows.push(["Error", "no noise"]);
  if (state.first_ms != null) rows.push(["First picture", `${Math.round(state.first_ms)} ms`]);
  if (state.tracing_seconds > 0) rows.push(["Speed", `${digits(state.rays / state.tracing_seconds / 1e6, 2)} M rays/s`]);
  list($("progress-list"), rows);
  const share = state.stride > 1 ? 0.5 / state.most : state.samples / state.most;
  $("progress").value = isDone() ? 1 : share;
  setStatus(bad ? "The file has mistakes" : isDone() ? "Picture complete" : state.stride > 1 ? "Coarse picture" : `Refining: ${what} samples`, bad);
  canvas.setAttribute("aria-label", `Frame ${state.frame} of ${info.frames || "?"}${state.heat ? `, map of ${state.heat}` : ""}, ${what} samples`);

  for (const heat of ["error", "rays"]) $(`heat-${heat}`).setAttribute("aria-pressed", state.heat === heat);
  $("scale").hidden = !(state.heat && state.heat_scale);
  if (state.heat && state.heat_scale) {
    const text = (value) => state.heat === "error" ? percent(value) : `${digits(value)} rays`;
    $("scale-from").textContent = text(state.heat_scale[0]);
    $("scale-to").textContent = text(state.heat_scale[1]);
  }
  const changed = new Set(state.changed);
  for (const [id, text] of [["bounces", state.bounces], ["antialias", `${state.antialias} × ${state.antialias}`], ["size", `${state.size[0]} × ${state.size[1]}`]]) {
    $(id).textContent = text;
    $(id).classList.toggle("changed", changed.has(id));
  }
  $("changed").hidden = changed.size === 0;
  $("changed").textContent = `Only on this page: ${[...changed].join(", ")}`;
  $("reset").disabled = changed.size === 0;
  $("projection").setAttribute("aria-pressed", state.parallel);
  $("camera-reset").disabled = !state.camera_moved;
  $("write-camera").hidden = !state.edit;
  $("write-camera").disabled = !state.camera_moved;
  showLights();
  showForecast();
  showRender();
  showClock();
}

// ---- Lights ----

const srgb = (x) => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));

/** The colour of a light without its intensity, for the screen. */
function hex(color) {
  const most = Math.max(1, ...color);
  return "#" + color.map((c) => srgb(Math.min(1, Math.max(0, c / most))).toString(16).padStart(2, "0")).join("");
}

let lightsShown = "";
function showLights() {
  const text = JSON.stringify([state.lights, state.edit]);
  if (text === lightsShown || $("lights").contains(document.activeElement) && document.activeElement.matches("input")) return;
  const focused = $("lights").contains(document.activeElement) ? document.activeElement.dataset.light : null;
  lightsShown = text;
  $("lights").replaceChildren(...state.lights.map((light, index) => {
    const row = document.createElement("li");
    const key = document.createElement("kbd");
    key.textContent = index < 9 ? index + 1 : "";
    key.setAttribute("aria-hidden", "true");
    const button = document.createElement("button");
    button.type = "button";
    button.className = "switch";
    button.dataset.light = index;
    button.setAttribute("aria-pressed", light.on);
    const lamp = document.createElement("i"), name = document.createElement("span");
    lamp.className = "lamp";
    lamp.style.background = hex(light.color);
    name.textContent = light.name;
    button.append(lamp, name);
    button.addEventListener("click", () => switchLight(index));
    const note = document.createElement("span");
    note.className = light.changed ? "own" : "quiet";
    note.textContent = light.changed ? (light.on ? "on here" : "off here") : light.on ? `× ${digits(light.intensity)}` : "off";
    row.append(key, button, note);
    if (state.edit) row.append(editor(light, index));
    return row;
  }));
  if (!state.lights.length) {
    const row = document.createElement("li");
    row.className = "quiet";
    row.style.display = "block";
    row.textContent = "The file has none.";
    $("lights").append(row);
  }
  if (focused != null) $("lights").querySelector(`[data-light="${focused}"]`)?.focus();
}

/** Fields that write into the file. */
function editor(light, index) {
  const box = document.createElement("div");
  box.className = "edit";
  const write = (field, value) => send({ do: "write-light", index, field, value });
  const intensity = document.createElement("input");
  Object.assign(intensity, { type: "number", min: 0, step: "any", value: digits(light.intensity, 6) });
  intensity.setAttribute("aria-label", `Intensity of ${light.name}, written to the file`);
  intensity.addEventListener("change", () => write("intensity", Number(intensity.value)));
  const color = document.createElement("input");
  Object.assign(color, { type: "color", value: hex(light.color) });
  color.setAttribute("aria-label", `Colour of ${light.name}, written to the file`);
  color.addEventListener("change", () => write("color", color.value));
  const on = document.createElement("button");
  on.type = "button";
  on.textContent = "Write on/off";
  on.style.whiteSpace = "nowrap";
  on.setAttribute("aria-label", `Write the switch of ${light.name} to the file`);
  on.addEventListener("click", () => write("on", light.on));
  box.append(intensity, color, on);
  return box;
}

function switchLight(index) {
  const light = state.lights?.[index];
  if (light) send({ do: "light", index, on: light.changed ? null : !light.on });
}

// ---- Quality and forecast ----

function showForecast() {
  const rows = state.forecast?.rows;
  const slider = $("samples");
  const random = state.random;
  const counts = rows ? rows.map((row) => row.count) : random ? [...Array(14).keys()].map((i) => 2 ** i) : [1, 2, 3, 4, 5, 6, 8, 10];
  const now = random ? state.quality_samples : state.antialias;
  slider.max = counts.length - 1;
  if (document.activeElement !== slider) {
    let nearest = 0;
    counts.forEach((count, i) => { if (Math.abs(Math.log(count / now)) < Math.abs(Math.log(counts[nearest] / now))) nearest = i; });
    slider.value = nearest;
  }
  slider.counts = counts;
  $("samples-label").firstChild.textContent = random ? "Samples per pixel " : "Grid of samples ";
  $("samples-value").textContent = random ? now : `${now} × ${now}`;
  $("samples-value").classList.toggle("changed", state.changed.includes(random ? "samples" : "antialias"));
  slider.setAttribute("aria-label", random ? "Samples per pixel" : "Grid of samples along a side");
  slider.setAttribute("aria-valuetext", $("samples-value").textContent);
  const row = rows && state.forecast.random === random && rows.reduce((best, row) => Math.abs(row.count - now) < Math.abs(best.count - now) ? row : best);
  $("predict").disabled = Boolean(state.forecasting);
  $("predict").textContent = state.forecasting ? "Measuring …" : "Predict time";
  $("forecast").textContent = row
    ? `All ${info.frames} frames: about ${duration(row.seconds[1])} (${duration(row.seconds[0])} to ${duration(row.seconds[2])})${row.error == null ? "" : `, error ${percent(row.error)}`}`
    : "";
}

// ---- Render ----

function showRender() {
  const run = state.render;
  const running = Boolean(run && !run.outcome);
  $("render-stop").hidden = !running;
  $("render-all").disabled = $("render-here").disabled = running || Boolean(state.diagnostics);
  $("render-progress").hidden = !running;
  if (!run) { $("render-state").textContent = ""; return; }
  $("render-progress").value = run.frames ? run.done / run.frames : 0;
  const outcome = run.outcome;
  $("render-state").textContent = running
    ? `${Math.floor(run.done)} of ${run.frames} frames`
    : outcome.error || (outcome.stopped != null ? `Stopped after ${outcome.stopped} frames` : `Wrote ${outcome.files.length > 2 ? `${outcome.files.length} files` : outcome.files.join(", ")}`);
}

// ---- Timeline ----

async function loadInfo() {
  asking = true;
  const answer = await send({ do: "info" });
  asking = false;
  if (!answer || answer.error || answer.frames == null) return;
  info = answer;
  document.title = `${info.name} · Kinora preview`;
  $("name").textContent = info.name;
  const count = (n, noun) => `${n} ${noun}${n === 1 ? "" : "s"}`;
  $("facts").textContent = `${count(info.frames, "frame")} · ${digits(info.duration)} s at ${digits(info.fps, 4)} fps · ${info.integrator} · ${count(info.objects, "object")}`;
  $("facts").title = (info.notes || []).join("\n");
  $("outputs").textContent = info.outputs.join(", ");
  $("scrub").max = info.frames - 1;
  if (range && range[1] >= info.frames) range = null;
  showTracks();
  describe();
}

const place = (time) => `${100 * Math.min(1, Math.max(0, time / (info.duration || 1)))}%`;

function showTracks() {
  const NS = "http://www.w3.org/2000/svg";
  const rows = info.curves.tracks.map((track) => {
    const lane = document.createElement("div"), label = document.createElement("span"), box = document.createElement("div");
    lane.className = "lane";
    lane.setAttribute("role", "listitem");
    label.className = "label";
    label.textContent = label.title = track.label;
    box.className = "track";
    const svg = document.createElementNS(NS, "svg");
    svg.setAttribute("viewBox", "0 0 1 1");
    svg.setAttribute("preserveAspectRatio", "none");
    svg.setAttribute("aria-hidden", "true");
    const all = track.lines.flat(), low = Math.min(...all), high = Math.max(...all);
    for (const line of track.lines) {
      const curve = document.createElementNS(NS, "polyline");
      const y = (value) => high > low ? 1 - (value - low) / (high - low) : 0.5;
      // Switches step.
      const steps = line.every((value) => value === 0 || value === 1);
      const corner = (i) => steps && i > 0 && line[i] !== line[i - 1] ? `${i / (line.length - 1)},${y(line[i - 1])} ` : "";
      curve.setAttribute("points", line.map((value, i) => `${corner(i)}${i / (line.length - 1)},${y(value)}`).join(" "));
      svg.append(curve);
    }
    box.append(svg);
    for (const time of track.keys) {
      const key = document.createElement("button");
      key.type = "button";
      key.className = "key";
      key.style.left = place(time);
      key.title = `${track.label}: key at ${digits(time, 4)} s`;
      key.setAttribute("aria-label", key.title);
      key.addEventListener("click", () => {
        const frame = Math.min(info.frames - 1, Math.round(time * info.fps));
        send({ do: "frame", frame });
        locate(track.names);
      });
      box.append(key);
    }
    lane.append(label, box);
    return lane;
  });
  $("tracks").replaceChildren(...rows);
}

let planShown = null;
function showPlan() {
  const text = JSON.stringify([state.plan, info.frames]);
  if (text === planShown || !info.frames) return;
  planShown = text;
  const spans = state.plan ? state.plan.spans : [];
  $("plan").replaceChildren(...spans.map((span) => {
    const part = document.createElement("span");
    part.className = span.kind;
    part.style.left = `${100 * span.first / info.frames}%`;
    part.style.width = `${100 * (span.last + 1 - span.first) / info.frames}%`;
    part.title = `Frames ${span.first} to ${span.last}: ${span.kind}`;
    return part;
  }));
  const text2 = state.plan ? `${state.plan.films} of ${info.frames} frames are traced, ${state.plan.reused} reuse a film` : "The plan is not known yet";
  $("plan").setAttribute("aria-label", text2);
  $("plan").title = text2;
}

let showScrub = true;
function showClock() {
  showPlan();
  const last = Math.max(0, (info.frames || 1) - 1);
  $("clock").textContent = `frame ${state.frame} of ${last} · ${digits(state.time || 0, 4)} s`;
  if (showScrub) $("scrub").value = state.frame;
  $("scrub").setAttribute("aria-valuetext", $("clock").textContent);
  $("play").textContent = state.playing ? "❚❚" : "▶";
  $("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
  const parts = [];
  if (state.playing) parts.push(`${digits(state.shown_per_second || 0, 3)} pictures/s`, `${state.dropped || 0} dropped`);
  if (range) parts.push(`loop ${range[0]}–${range[1]}`);
  $("play-state").textContent = parts.join(" · ");
  const lane = $("plan"), box = $("timeline");
  const share = state.time / (info.duration || 1);
  $("playhead").style.left = `${lane.offsetLeft + lane.offsetWidth * Math.min(1, share)}px`;
  $("playhead").style.height = `${box.scrollHeight - 24}px`;
  let mark = box.querySelector(".range");
  if (range && info.frames) {
    if (!mark) { mark = document.createElement("div"); mark.className = "range"; box.append(mark); }
    mark.style.left = `${lane.offsetLeft + lane.offsetWidth * range[0] / info.frames}px`;
    mark.style.width = `${lane.offsetWidth * (range[1] + 1 - range[0]) / info.frames}px`;
  } else mark?.remove();
}

/** Shows where a value is in the file. */
async function locate(names) {
  const answer = await send({ do: "place", names });
  if (!answer || answer.error) return;
  $("source").hidden = false;
  $("source-title").textContent = `${answer.file}:${answer.line}`;
  $("source-text").replaceChildren(...answer.lines.flatMap((line, index) => {
    const number = document.createElement("i"), text = document.createElement("span");
    number.textContent = String(answer.first + index).padStart(4) + "  ";
    text.textContent = line;
    if (answer.first + index === answer.line) text.className = "here";
    return [number, text, "\n"];
  }));
}

// ---- Latest-only commands: while one is under way, only the last of its kind waits ----

const waiting = new Map();
const busy = new Set();
async function latest(kind, command, merge) {
  waiting.set(kind, waiting.has(kind) && merge ? merge(waiting.get(kind), command) : command);
  if (busy.has(kind)) return;
  busy.add(kind);
  while (waiting.has(kind)) {
    const next = waiting.get(kind);
    waiting.delete(kind);
    await send(next);
  }
  busy.delete(kind);
}

// The frame that is asked for, until it is shown: keys may come faster than pictures.
let wanted = null;
function goTo(frame) {
  wanted = Math.min(Math.max(0, frame), (info.frames || 1) - 1);
  latest("frame", { do: "frame", frame: wanted });
}

function moveCamera(move) {
  const sum = (a, b) => {
    if ("factor" in b) return { ...b, factor: Math.min(1000, Math.max(0.001, a.factor * b.factor)) };
    return { ...b, x: (a.x || 0) + (b.x || 0), y: (a.y || 0) + (b.y || 0), z: (a.z || 0) + (b.z || 0) };
  };
  latest(`camera-${move.move}`, { do: "camera", ...move }, sum);
}

// ---- Mouse ----

let drag = null;
let picked = null;

canvas.addEventListener("pointerdown", (event) => {
  canvas.focus({ preventScroll: true });
  canvas.setPointerCapture(event.pointerId);
  drag = { x: event.clientX, y: event.clientY, moved: false, pan: event.shiftKey || event.button !== 0 };
});
canvas.addEventListener("pointermove", (event) => {
  if (!drag) return;
  const dx = event.clientX - drag.x, dy = event.clientY - drag.y;
  if (!drag.moved && Math.hypot(dx, dy) < 4) return;
  drag.moved = true;
  canvas.classList.add("moving");
  Object.assign(drag, { x: event.clientX, y: event.clientY });
  const height = canvas.getBoundingClientRect().height;
  if (drag.pan) moveCamera({ move: "pan", x: -dx / height, y: dy / height });
  else moveCamera({ move: "orbit", x: Math.PI * dx / height, y: Math.PI * dy / height });
});
canvas.addEventListener("pointerup", (event) => {
  if (drag && !drag.moved && event.button === 0) pickAt(event);
  drag = null;
  canvas.classList.remove("moving");
});
canvas.addEventListener("pointercancel", () => { drag = null; canvas.classList.remove("moving"); });
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  const pixels = event.deltaMode ? event.deltaY * 30 : event.deltaY;
  const factor = Math.exp(Math.min(300, Math.max(-300, pixels)) / 600);
  moveCamera({ move: event.ctrlKey || event.altKey ? "zoom" : "dolly", factor });
}, { passive: false });

async function pickAt(event) {
  const box = canvas.getBoundingClientRect();
  const x = Math.floor((event.clientX - box.left) / box.width * canvas.width);
  const y = Math.floor((event.clientY - box.top) / box.height * canvas.height);
  if (x < 0 || y < 0 || x >= canvas.width || y >= canvas.height) return;
  const found = await send({ do: "pick", x, y });
  if (!found || found.error) return;
  picked = { x, y };
  placeOverlays();
  $("pick-hint").hidden = true;
  const vector = (v) => v.map((n) => digits(n)).join(", ");
  const rows = [["Pixel", `${x}, ${y}`]];
  const link = (text, names) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = text;
    button.title = "Show the place in the file";
    button.addEventListener("click", () => locate(names));
    return button;
  };
  if (found.object) rows.push(["Object", link(found.object, ["objects", found.object])]);
  else if (found.lamp) rows.push(["Light", link(found.lamp, ["lights", found.lamp])]);
  else rows.push(["Object", "background"]);
  if (found.material) rows.push(["Material", found.material === found.object ? found.material : link(found.material, ["materials", found.material])]);
  if (found.distance != null) rows.push(["Distance", digits(found.distance, 4)], ["Point", vector(found.point)], ["Normal", vector(found.normal)]);
  const rays = Object.entries(found.rays).map(([kind, count]) => `${count} ${kind}`).join(", ");
  rows.push(["Rays", rays]);
  list($("pick"), rows);
  $("shares").replaceChildren(...found.light.map(({ name, share }) => {
    const row = document.createElement("li"), label = document.createElement("span"), value = document.createElement("span"), meter = document.createElement("meter");
    label.textContent = name === "constant" ? "other light" : name;
    value.textContent = percent(share);
    meter.value = share;
    meter.setAttribute("aria-label", `Share of ${label.textContent}`);
    row.append(label, value, meter);
    return row;
  }));
}

// ---- Commands by key; buttons name the key of their command ----

async function copy(what) {
  const answer = await send({ do: what });
  if (!answer || answer.error) return;
  $("copied").hidden = false;
  $("copied").textContent = answer.text;
  try {
    await navigator.clipboard.writeText(answer.text);
    toast("Copied");
  } catch {
    toast("Select the text to copy it");
  }
}

const set = (what, value) => send({ do: what, value });
const heat = (kind) => kind === "error" && !state.random && state.heat !== kind ? toast("This picture has no noise: its samples are a grid") : send({ do: "heat", kind: state.heat === kind ? null : kind });
const resize = (factor) => {
  if (!state.size) return;
  const [width, height] = state.size.map((side) => Math.max(1, Math.round(side * factor)));
  if (Math.max(width, height) <= 16384) send({ do: "size", width, height });
};
const aaSteps = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16];
const antialias = (by) => {
  const at = aaSteps.findIndex((step) => step >= state.antialias);
  set("antialias", aaSteps[Math.min(aaSteps.length - 1, Math.max(0, at + by))]);
};

function toggleSplit() {
  if (!reference) return;
  isSplit = !isSplit;
  $("split-box").hidden = !isSplit;
  $("split-button").setAttribute("aria-pressed", isSplit);
  paint();
}

let loops = true;
function play() {
  if (state.playing) return send({ do: "pause" });
  const [from, to] = range || [0, (info.frames || 1) - 1];
  return send({ do: "play", from, to, loop: loops });
}

const step = (x, y, z) => moveCamera({ move: "step", x, y, z });
const commands = {
  " ": play,
  ",": () => goTo((wanted ?? state.frame) - 1),
  ".": () => goTo((wanted ?? state.frame) + 1),
  Home: () => goTo(0),
  End: () => goTo(info.frames - 1),
  l: () => { loops = !loops; $("loop").setAttribute("aria-pressed", loops); if (state.playing) send({ do: "play", from: range?.[0] || 0, to: range?.[1] ?? info.frames - 1, loop: loops }); },
  i: () => { range = [state.frame, Math.max(state.frame, range?.[1] ?? info.frames - 1)]; showClock(); },
  o: () => { range = [Math.min(state.frame, range?.[0] ?? 0), state.frame]; showClock(); },
  "+": () => set("bounces", Math.min(1000, state.bounces + 1)),
  "=": () => set("bounces", Math.min(1000, state.bounces + 1)),
  "-": () => set("bounces", Math.max(0, state.bounces - 1)),
  a: () => antialias(1),
  A: () => antialias(-1),
  "]": () => resize(2),
  "[": () => resize(0.5),
  p: () => send({ do: "camera", move: "projection" }),
  c: () => copy("copy-camera"),
  k: () => copy("copy-key"),
  e: () => heat("error"),
  y: () => heat("rays"),
  r: () => { if (!bitmap) return; reference = bitmap; $("split-button").disabled = false; if (!isSplit) toggleSplit(); toast("Kept as reference"); },
  s: toggleSplit,
  0: () => { range = null; send({ do: "reset" }); },
  "?": () => $("help").showModal(),
  h: () => $("help").showModal(),
  ArrowLeft: () => step(-0.05, 0, 0),
  ArrowRight: () => step(0.05, 0, 0),
  ArrowUp: () => step(0, 0, 0.05),
  ArrowDown: () => step(0, 0, -0.05),
  PageUp: () => step(0, 0.05, 0),
  PageDown: () => step(0, -0.05, 0),
  Escape: () => { $("source").hidden = true; },
};

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || $("help").open || !owned) return;
  const field = event.target.closest("input, select, textarea, pre");
  const isRange = field && field.type === "range";
  const movesFocus = /^(Arrow|Page|Home|End)/.test(event.key);
  if (field && (!isRange || movesFocus)) return;
  // Buttons react to the space bar and to Enter themselves.
  if (event.key === " " && event.target.closest("button, a")) return;
  if (/^[1-9]$/.test(event.key)) { switchLight(Number(event.key) - 1); return; }
  const command = commands[event.key] || (event.key !== "A" && commands[event.key.toLowerCase()]);
  if (!command) return;
  event.preventDefault();
  command();
});

for (const button of document.querySelectorAll("button[data-key]")) {
  button.addEventListener("click", () => commands[button.dataset.key]());
  const key = button.dataset.key === " " ? "space" : button.dataset.key;
  button.title = `${button.getAttribute("aria-label") || button.textContent} (${key})`;
}
$("help-button").addEventListener("click", () => $("help").showModal());
$("camera-reset").addEventListener("click", () => send({ do: "camera", move: "reset" }));
$("write-camera").addEventListener("click", async () => {
  const answer = await send({ do: "write-camera" });
  if (answer?.written) toast("Written to the file");
});
$("predict").addEventListener("click", () => send({ do: "forecast" }));
$("samples").addEventListener("input", () => {
  const count = $("samples").counts[$("samples").value];
  latest("samples", { do: state.random ? "samples" : "antialias", value: count });
});
$("render-all").addEventListener("click", () => send({ do: "render", from: 0 }));
$("render-here").addEventListener("click", () => send({ do: "render", from: state.frame }));
$("render-stop").addEventListener("click", () => send({ do: "stop-render" }));
$("scrub").addEventListener("input", () => { showScrub = false; goTo(Number($("scrub").value)); });
$("scrub").addEventListener("change", () => { showScrub = true; });
$("split").addEventListener("input", paint);
$("source-close").addEventListener("click", () => { $("source").hidden = true; });
$("take-over").addEventListener("click", own);
addEventListener("resize", () => { paint(); if (state.size) showClock(); });

let toastTimer = 0;
function toast(text) {
  $("toast").textContent = text;
  $("toast").classList.add("shown");
  clearTimeout(toastTimer);
  toastTimer = setTimeout(() => $("toast").classList.remove("shown"), 2600);
}

own().catch(() => setStatus("The preview cannot be reached.", true));
