"use strict";
// The first picture as a view to turn: what is written round the drawing, and the buttons. It stands on viewer/camera.js and surfaces.js.
(() => {
  const packed = document.getElementById("scene");
  const place = document.getElementById("view");
  if (!packed) return;
  const told = JSON.parse(packed.textContent);
  const [low, high] = told.box;
  const size = minus(high, low);
  const middle = onward(low, 0.5, size);
  const surfaces = told.surfaces.map((one) => unpackedSurface(one, told.box));
  const canvas = document.createElement("canvas");
  let painter;
  try {
    painter = new Painter(canvas, surfaces, told.colours);
  } catch {
    return; // no WebGL 2: the still picture stays
  }
  const page = document.documentElement.classList;
  page.add("drawn");
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  canvas.setAttribute("aria-label", `${document.querySelector(".still").alt}. Arrow keys turn it, plus and minus zoom, Enter reads the middle.`);
  place.append(canvas);
  canvas.addEventListener("webglcontextlost", (event) => {
    event.preventDefault(); // it may come back
    page.remove("drawn");
  });
  canvas.addEventListener("webglcontextrestored", () => {
    painter.prepare();
    page.add("drawn");
    draw();
  });

  // ---- what is seen, and how
  const shown = { worn: true, lost: false, design: false };
  let view = told.views[0];
  let range = { limit: view.limit, linear: view.linear };
  let section = null;
  const LEGEND = 84, LABELS = 24; // px kept free on the right, and round the gear
  const camera = new Camera(middle, 0.5 * Math.hypot(...size));
  camera.aside = 0.5 * LEGEND;
  const tip = 0.5 * Math.max(size[0], size[1]);
  const rims = []; // places round both ends, from the middle
  for (let angle = 0; angle < 2 * Math.PI; angle += 0.1) {
    for (const end of [-0.5, 0.5]) rims.push([tip * Math.cos(angle), tip * Math.sin(angle), end * size[2]]);
  }
  let moved = false; // by the reader; until then a canvas of another size, as of a phone that is turned, is filled anew
  /** All of the gear, as large as it goes. */
  function home() {
    moved = false;
    camera.look(told.eye, 1);
    const { right, up, back, scale, width, height } = camera;
    const wide = scale / (0.5 * (width - LEGEND) - LABELS);
    const high = scale / (0.5 * height - LABELS);
    const reach = (at) => Math.max(wide * Math.abs(dot(at, right)), high * Math.abs(dot(at, up)));
    camera.away = Math.max(...rims.map((at) => dot(at, back) + reach(at)));
    draw();
  }
  const element = (parent, tag, name, text = "") => {
    const made = document.createElement(tag);
    made.className = name;
    made.textContent = text;
    parent.append(made);
    return made;
  };
  const shape = (parent, tag) => parent.appendChild(document.createElementNS("http://www.w3.org/2000/svg", tag));
  const signed = (value, digits) => (value < 0 ? "−" : "+") + Math.abs(value).toFixed(digits);
  const key = document.getElementById("legend");
  function legend() {
    key.replaceChildren();
    element(key, "p", "", view.title);
    const bar = element(key, "div", "ramp");
    const shades = told.colours.scale;
    const [first, last] = [view.low, view.high].map((end) => Math.round(0.5 * (end + 1) * (shades.length - 1)));
    bar.style.background = `linear-gradient(to top, ${shades.slice(first, last + 1).join(",")})`;
    const even = [-1, -0.5, 0, 0.5, 1].filter((at) => at >= view.low && at <= view.high);
    const label = (at) => (view.high === 0 ? Math.abs(at) * range.limit : at * range.limit).toPrecision(3).replace("-", "−");
    const ticks = range.limit === view.limit && range.linear === view.linear ? view.ticks : even.map((at) => [at, label(at)]);
    for (const [at, text] of ticks) element(bar, "span", "", text).style.bottom = `${(100 * (at - view.low)) / (view.high - view.low)}%`;
  }

  // ---- what stays on the part: labels, and the two places that are measured
  const notes = element(place, "div", "notes");
  const labels = told.labels.map((one) => ({ at: one.at, shown: element(notes, "span", "tooth", one.text), out: true }));
  const pitch = (2 * Math.PI) / labels.length;
  const first = Math.atan2(labels[0].at[1], labels[0].at[0]);
  const aside = Math.atan2(told.eye[1], told.eye[0]) + 1.35 - first; // of the first tooth: to the right, and between two numbers
  const side = first + (Math.floor(aside / pitch) + 0.5) * pitch;
  for (const z of [0, told.faceWidth]) {
    const at = [1.1 * tip * Math.cos(side), 1.1 * tip * Math.sin(side), z];
    labels.push({ at, shown: element(notes, "span", "height", `z = ${Number(z.toPrecision(6))}`), out: false });
  }
  const picked = []; // one place, or two to measure between
  const tape = shape(notes, "svg");
  const line = shape(tape, "line");
  const dots = [0, 1].map(() => shape(tape, "circle"));
  const tags = dots.map(() => element(notes, "span", "pick"));
  const move = (note, x, y, beside = "-50%, -50%") => (note.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(${beside})`);
  const over = (note, x, y) => move(note, x, y, `${(-100 * x) / camera.width}%, -120%`); // and never beyond the canvas
  function overlay() {
    const toward = camera.back;
    for (const { at, shown: note, out } of labels) {
      const there = camera.project(at);
      const from = minus(at, middle);
      const facing = (from[0] * toward[0] + from[1] * toward[1]) / (Math.hypot(from[0], from[1]) || 1);
      note.hidden = there.depth <= 0 || (out && facing < -0.05 && toward[2] < 0.5);
      move(note, there.x, there.y);
    }
    const ends = picked.map((reading) => camera.project(reading.point));
    tape.setAttribute("visibility", ends.every((end) => end.depth > 0) ? "visible" : "hidden");
    line.setAttribute("visibility", ends.length === 2 ? "inherit" : "hidden");
    dots.forEach((dot, i) => {
      const end = ends[i];
      dot.setAttribute("r", end ? 4 : 0);
      tags[i].hidden = !end || end.depth <= 0;
      if (!end) return;
      for (const [name, value] of Object.entries({ cx: end.x, cy: end.y })) dot.setAttribute(name, value.toFixed(2));
      for (const [name, value] of Object.entries({ x: end.x, y: end.y })) line.setAttribute(name + (i + 1), value.toFixed(2));
      tags[i].textContent = i ? `${distance(picked[0].point, picked[1].point).toFixed(3)} mm` : brief(picked[0]);
      over(tags[i], end.x, end.y);
    });
  }

  let waiting = false;
  function draw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      if (!camera.width || painter.gl.isContextLost()) return;
      painter.draw(camera, { shown, view, range, section });
      overlay();
      place.setAttribute("data-ready", "yes");
    });
  }
  new ResizeObserver(() => {
    if (!place.clientWidth) return;
    [camera.width, camera.height] = [place.clientWidth, place.clientHeight];
    if (moved) draw();
    else home();
  }).observe(place);
  function watchDensity() {
    const now = window.matchMedia(`(resolution: ${devicePixelRatio}dppx)`);
    now.addEventListener("change", () => (draw(), watchDensity()), { once: true }); // on a screen with other pixels
  }
  watchDensity();

  // ---- reading a point
  function under(x, y) {
    const solid = surfaces.filter((one) => one.group !== "design" && shown[one.group]);
    const hit = met(solid, camera.ray(x, y), section);
    if (!hit) return null;
    const { surface, corner, point, cut } = hit;
    const tooth = surface.teeth.filter(([start]) => start <= corner).pop()[1];
    return { point, tooth, name: cut ? "section" : surface.name, read: cut ? {} : readAt(surface, corner) };
  }
  const said = (one, um) => (one.key === "wear" ? `wear ${Math.abs(um).toFixed(1)} µm` : `${one.label.toLowerCase()} ${signed(um, 1)} µm`);
  const brief = (reading) => {
    const um = reading.read[view.key];
    return `tooth ${reading.tooth} · ${reading.name}` + (um === undefined ? "" : ` · ${said(view, um)}`);
  };
  const hover = element(notes, "span", "hover");
  hover.hidden = true;
  let pointed = null; // where the mouse is; read once a frame
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerType === "touch") return;
    if (!pointed) requestAnimationFrame(hovered);
    const box = canvas.getBoundingClientRect();
    pointed = { x: event.clientX - box.left, y: event.clientY - box.top, pressed: event.buttons > 0 };
  });
  function hovered() {
    const { x, y, pressed } = pointed;
    pointed = null;
    const reading = pressed ? null : under(x, y);
    hover.hidden = !reading;
    if (!reading) return;
    hover.textContent = brief(reading);
    over(hover, x, y);
  }
  canvas.addEventListener("pointerleave", () => (hover.hidden = true));

  const readout = document.getElementById("readout");
  const measuring = document.getElementById("measure");
  const pressed = (button) => button.getAttribute("aria-pressed") === "true";
  function pick(reading) {
    if (!pressed(measuring) || picked.length === 2) picked.length = 0;
    picked.push(reading);
    const { point, tooth, name, read } = reading;
    const all = told.views.filter((one) => read[one.key] !== undefined).map((one) => said(one, read[one.key]));
    const where = [`r ${Math.hypot(point[0], point[1]).toFixed(2)} mm`, `z ${point[2].toFixed(2)} mm`];
    readout.textContent = [`Picked: tooth ${tooth}`, name, ...where, ...all].join(" · ");
    if (picked.length === 2) {
      const [x, y, z] = minus(picked[0].point, picked[1].point);
      const strong = element(readout, "b", "", ` · distance ${Math.hypot(x, y, z).toFixed(3)} mm`);
      strong.append(` (Δx ${signed(x, 3)}, Δy ${signed(y, 3)}, Δz ${signed(z, 3)})`);
    }
    draw();
  }
  steer(canvas, camera, {
    changed: () => {
      moved = true;
      draw();
    },
    home,
    tapped: (x, y) => {
      const reading = under(x, y);
      if (reading) pick(reading);
    },
  });

  // ---- buttons
  const press = (button, on) => button.setAttribute("aria-pressed", String(on));
  const caption = document.getElementById("under");
  const limit = document.getElementById("range");
  function repaint() {
    range = Number(limit.value) > 0 ? { limit: Number(limit.value), linear: null } : { limit: view.limit, linear: view.linear };
    legend();
    draw();
  }
  limit.addEventListener("input", repaint);
  for (const button of document.querySelectorAll("[data-view]")) {
    button.addEventListener("click", () => {
      view = told.views.find((one) => one.key === button.dataset.view);
      limit.value = "";
      limit.placeholder = view.limit;
      for (const other of document.querySelectorAll("[data-view]")) press(other, other === button);
      caption.textContent = view.words;
      repaint();
    });
  }
  for (const button of document.querySelectorAll("[data-group]")) {
    button.addEventListener("click", () => {
      shown[button.dataset.group] = !pressed(button);
      press(button, !pressed(button));
      draw();
    });
  }
  measuring.addEventListener("click", () => {
    press(measuring, !pressed(measuring));
    picked.length = 0;
    readout.textContent = pressed(measuring) ? "Click two points to measure between them." : "Click a point to read it.";
    draw();
  });
  const how = document.getElementById("cut");
  const where = document.getElementById("cut-at");
  const words = document.getElementById("cut-words");
  function cut() {
    const share = Number(where.value);
    where.hidden = how.value === "none";
    if (how.value === "across") {
      const z = share * told.faceWidth;
      section = [0, 0, -1, z];
      words.textContent = `z = ${z.toFixed(2)} mm`;
    } else if (how.value === "along") {
      const angle = 2 * Math.PI * share;
      section = [-Math.sin(angle), Math.cos(angle), 0, 0];
      words.textContent = `${((360 * share) % 360).toFixed(1)}°`;
    } else {
      section = null;
      words.textContent = "";
    }
    draw();
  }
  how.addEventListener("change", cut);
  where.addEventListener("input", cut);
  document.getElementById("home").addEventListener("click", home);
  repaint();
  window.gearView = { camera, surfaces, under, picked, canvas, draw, section: () => section }; // for a console, and for tests
})();
