"use strict";
(() => {
  const packed = document.getElementById("scene");
  const place = document.getElementById("view");
  if (!packed || !document.createElement("canvas").getContext("webgl2")) return; // the still picture stays
  const told = JSON.parse(packed.textContent);
  document.documentElement.classList.add("drawn");

  // ---- what is drawn
  const ARRAYS = { u2: Uint16Array, u4: Uint32Array, i2: Int16Array };
  const unpacked = (kind, text) => new ARRAYS[kind](Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
  const [low, high] = told.box.map((corner) => new THREE.Vector3(...corner));
  const size = high.clone().sub(low);
  const middle = low.clone().add(high).multiplyScalar(0.5);
  const reach = 0.5 * Math.hypot(size.x, size.z);
  const shades = told.colours.scale.map((name) => new THREE.Color(name));
  const unseen = new THREE.Color(told.colours.unseen);
  const cuts = []; // the section plane, once there is one

  const scene = new THREE.Scene();
  const groups = Object.fromEntries(["worn", "lost", "design"].map((name) => [name, new THREE.Group()]));
  scene.add(...Object.values(groups));
  const inside = new THREE.MeshBasicMaterial({ color: told.colours.inside, side: THREE.BackSide, clippingPlanes: cuts });

  function surface(one) {
    const whole = unpacked("u2", one.corners.data);
    const corners = new Float32Array(whole.length);
    const step = size.clone().divideScalar(65535).toArray();
    for (let i = 0; i < whole.length; i++) corners[i] = told.box[0][i % 3] + step[i % 3] * whole[i];
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    geometry.setIndex(new THREE.BufferAttribute(unpacked(one.faces.kind, one.faces.data), 1));
    geometry.computeVertexNormals();
    const known = Object.entries(one.values || {}).map(([key, value]) => [key, { step: value.step, at: unpacked("i2", value.data) }]);
    const see = one.group === "design" ? { transparent: true, opacity: 0.22, depthWrite: false, side: THREE.DoubleSide } : {};
    const material = new THREE.MeshLambertMaterial({ color: one.colour, clippingPlanes: cuts, ...see });
    const drawn = new THREE.Mesh(geometry, material);
    Object.assign(drawn.userData, { name: one.name, teeth: one.teeth, colour: one.colour, values: Object.fromEntries(known) });
    groups[one.group].add(drawn);
    if (one.group === "worn") {
      geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(whole.length), 3));
      groups.worn.add(new THREE.Mesh(geometry, inside)); // what a section looks into
    }
  }
  told.surfaces.forEach(surface);
  groups.lost.visible = groups.design.visible = false;

  // ---- colours
  let view = told.views[0];
  let range = { limit: view.limit, linear: view.linear };
  const fraction = (um) => {
    const share = range.linear ? Math.asinh(um / range.linear) / Math.asinh(range.limit / range.linear) : um / range.limit;
    return Math.min(Math.max(share, view.low), view.high);
  };
  function paint() {
    const blend = new THREE.Color();
    for (const drawn of groups.worn.children) {
      const { values, colour } = drawn.userData;
      if (!values) continue;
      const known = values[view.key];
      drawn.material.vertexColors = Boolean(known);
      drawn.material.color.set(known ? "#ffffff" : colour);
      drawn.material.needsUpdate = true;
      if (!known) continue;
      const colours = drawn.geometry.getAttribute("color");
      for (let i = 0; i < known.at.length; i++) {
        if (known.at[i] === -32768) blend.copy(unseen);
        else {
          const at = 0.5 * (fraction(known.step * known.at[i]) + 1) * (shades.length - 1);
          const under = Math.min(Math.floor(at), shades.length - 2);
          blend.lerpColors(shades[under], shades[under + 1], at - under);
        }
        colours.setXYZ(i, blend.r, blend.g, blend.b);
      }
      colours.needsUpdate = true;
    }
    legend();
    draw();
  }
  const signed = (value, digits) => (value < 0 ? "−" : "+") + Math.abs(value).toFixed(digits);
  const element = (parent, tag, name, text = "") => {
    const made = document.createElement(tag);
    made.className = name;
    made.textContent = text;
    parent.append(made);
    return made;
  };
  const key = document.getElementById("legend");
  function legend() {
    key.replaceChildren();
    element(key, "p", "", view.title);
    const bar = element(key, "div", "ramp");
    const first = Math.round(0.5 * (view.low + 1) * (shades.length - 1));
    const last = Math.round(0.5 * (view.high + 1) * (shades.length - 1));
    bar.style.background = `linear-gradient(to top, ${told.colours.scale.slice(first, last + 1).join(",")})`;
    const own = [-1, -0.5, 0, 0.5, 1].filter((at) => at >= view.low && at <= view.high);
    const label = (at) => (view.high === 0 ? Math.abs(at) * range.limit : at * range.limit).toPrecision(3).replace("-", "−");
    const ticks = range.limit === view.limit && range.linear === view.linear ? view.ticks : own.map((at) => [at, String(label(at))]);
    for (const [at, text] of ticks) element(bar, "span", "", text).style.bottom = `${(100 * (at - view.low)) / (view.high - view.low)}%`;
  }

  // ---- camera and light
  const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.localClippingEnabled = true;
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  place.append(renderer.domElement);
  const camera = new THREE.PerspectiveCamera(28, 1, 0.05 * reach, 60 * reach);
  camera.up.set(0, 0, 1);
  const lamp = new THREE.DirectionalLight("#ffffff", 0.95);
  scene.add(new THREE.AmbientLight("#ffffff", 2.45), camera);
  camera.add(lamp);
  lamp.position.set(-0.5, 0.9, 1);
  camera.add(lamp.target);
  lamp.target.position.set(0, 0, -1);
  const LEGEND = 70; // px kept free on the right
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  function home() {
    const half = Math.tan((0.5 * camera.fov * Math.PI) / 180);
    const free = (place.clientWidth - LEGEND) / place.clientHeight; // width over height of what the legend leaves
    const away = (Math.hypot(0.5 * size.x, 0.3 * size.z) * Math.max(1.2 / free, 0.85)) / half;
    camera.position.set(...told.eye).multiplyScalar(away).add(middle);
    controls.target.copy(middle);
    controls.update();
    draw();
  }

  // ---- labels that stay on the part
  const notes = element(place, "div", "notes");
  const labels = told.labels.map((one) => ({ at: new THREE.Vector3(...one.at), shown: element(notes, "span", "tooth", one.text), out: true }));
  const side = Math.atan2(told.eye[1], told.eye[0]) + 1.35;
  const edge = 1.1 * 0.5 * Math.max(size.x, size.y);
  for (const z of [0, told.faceWidth]) {
    const at = new THREE.Vector3(edge * Math.cos(side), edge * Math.sin(side), z);
    labels.push({ at, shown: element(notes, "span", "height", `z = ${Number(z.toPrecision(6))}`), out: false });
  }
  const picked = []; // one place, or two to measure between
  const markers = [0, 1].map(() => {
    const ball = new THREE.Mesh(new THREE.SphereGeometry(0.007 * reach, 16, 12), new THREE.MeshBasicMaterial({ color: "#c8400a", depthTest: false }));
    ball.renderOrder = 2;
    ball.visible = false;
    scene.add(ball);
    return { ball, label: { at: ball.position, shown: element(notes, "span", "pick"), out: false } };
  });
  const tape = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: "#c8400a", depthTest: false }));
  tape.renderOrder = 2;
  tape.visible = false;
  scene.add(tape);
  labels.push(...markers.map((marker) => marker.label));

  let waiting = false;
  function draw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      renderer.render(scene, camera);
      const [width, height] = [place.clientWidth, place.clientHeight];
      const toward = camera.position.clone().sub(middle).normalize();
      for (const { at, shown, out } of labels) {
        const there = at.clone().project(camera);
        const around = Math.hypot(at.x - middle.x, at.y - middle.y) || 1;
        const facing = ((at.x - middle.x) * toward.x + (at.y - middle.y) * toward.y) / around;
        shown.hidden = shown.textContent === "" || there.z > 1 || (out && facing < -0.05 && toward.z < 0.5);
        shown.style.transform = `translate(${(0.5 * (there.x + 1) * width).toFixed(1)}px, ${(0.5 * (1 - there.y) * height).toFixed(1)}px) translate(-50%, -50%)`;
      }
      place.setAttribute("data-ready", "yes");
    });
  }
  controls.addEventListener("change", draw);
  let started = false;
  new ResizeObserver(() => {
    if (!place.clientWidth) return;
    renderer.setSize(place.clientWidth, place.clientHeight);
    camera.aspect = place.clientWidth / place.clientHeight;
    camera.setViewOffset(place.clientWidth, place.clientHeight, 0.5 * LEGEND, 0, place.clientWidth, place.clientHeight);
    camera.updateProjectionMatrix();
    if (started) draw();
    else home();
    started = true;
  }).observe(place);

  // ---- reading a point
  const ray = new THREE.Raycaster();
  function under(event) {
    const box = renderer.domElement.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left)) / box.width - 1;
    ray.setFromCamera(new THREE.Vector2(x, 1 - (2 * (event.clientY - box.top)) / box.height), camera);
    const solid = [...(groups.worn.visible ? groups.worn.children : []), ...(groups.lost.visible ? groups.lost.children : [])];
    const hit = ray.intersectObjects(solid.filter((one) => one.userData.name)).find((one) => cuts.every((cut) => cut.distanceToPoint(one.point) >= 0));
    if (!hit) return null;
    const corners = hit.object.geometry.getAttribute("position");
    const away = (i) => hit.point.distanceTo(new THREE.Vector3().fromBufferAttribute(corners, i));
    const nearest = [hit.face.a, hit.face.b, hit.face.c].sort((one, other) => away(one) - away(other))[0];
    const { name, teeth, values } = hit.object.userData;
    const read = {};
    for (const [view, known] of Object.entries(values)) {
      if (known.at[nearest] !== -32768) read[view] = known.step * known.at[nearest];
    }
    return { point: hit.point, name, tooth: teeth.filter(([start]) => start <= nearest).pop()[1], read };
  }
  const said = (one, um) => (one.key === "wear" ? `wear ${Math.abs(um).toFixed(1)} µm` : `${one.label.toLowerCase()} ${signed(um, 1)} µm`);
  const brief = (found) => {
    const um = found.read[view.key];
    return `tooth ${found.tooth} · ${found.name}` + (um === undefined ? "" : ` · ${said(view, um)}`);
  };
  const hover = element(notes, "span", "hover");
  hover.hidden = true;
  let pressed = null;
  const canvas = renderer.domElement;
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons || event.pointerType === "touch") return;
    const found = under(event);
    hover.hidden = !found;
    if (!found) return;
    const box = place.getBoundingClientRect();
    hover.textContent = brief(found);
    const beside = event.clientX - box.left < 0.55 * box.width ? "12px" : "calc(-100% - 12px)";
    hover.style.transform = `translate(${event.clientX - box.left}px, ${event.clientY - box.top}px) translate(${beside}, -120%)`;
  });
  canvas.addEventListener("pointerleave", () => (hover.hidden = true));
  canvas.addEventListener("pointerdown", (event) => (pressed = [event.clientX, event.clientY]));
  canvas.addEventListener("pointerup", (event) => {
    if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
    const found = under(event);
    if (found) pick(found);
  });

  const readout = document.getElementById("readout");
  const measuring = document.getElementById("measure");
  function pick(found) {
    if (measuring.getAttribute("aria-pressed") !== "true" || picked.length === 2) picked.length = 0;
    picked.push(found);
    const all = told.views.filter((one) => found.read[one.key] !== undefined).map((one) => said(one, found.read[one.key]));
    const place = [`r ${Math.hypot(found.point.x, found.point.y).toFixed(2)} mm`, `z ${found.point.z.toFixed(2)} mm`];
    readout.textContent = ["Picked: tooth " + found.tooth, found.name, ...place, ...all].join(" · ");
    if (picked.length === 2) {
      const apart = picked[0].point.clone().sub(picked[1].point);
      const strong = element(readout, "b", "", ` · distance ${apart.length().toFixed(3)} mm`);
      strong.append(` (Δx ${signed(apart.x, 3)}, Δy ${signed(apart.y, 3)}, Δz ${signed(apart.z, 3)})`);
    }
    show();
  }
  function show() {
    markers.forEach(({ ball, label }, i) => {
      ball.visible = i < picked.length;
      if (ball.visible) ball.position.copy(picked[i].point);
      label.shown.textContent = !ball.visible ? "" : i ? `${picked[0].point.distanceTo(picked[1].point).toFixed(3)} mm` : brief(picked[0]);
    });
    tape.visible = picked.length === 2;
    if (tape.visible) tape.geometry.setFromPoints(picked.map((found) => found.point));
    draw();
  }

  // ---- buttons
  const press = (button, on) => button.setAttribute("aria-pressed", String(on));
  const caption = document.getElementById("under");
  const own = document.getElementById("range");
  for (const button of document.querySelectorAll("[data-view]")) {
    button.addEventListener("click", () => {
      view = told.views.find((one) => one.key === button.dataset.view);
      range = { limit: view.limit, linear: view.linear };
      own.value = "";
      for (const other of document.querySelectorAll("[data-view]")) press(other, other === button);
      caption.textContent = view.words;
      paint();
      show();
    });
  }
  for (const button of document.querySelectorAll("[data-group]")) {
    button.addEventListener("click", () => {
      const on = button.getAttribute("aria-pressed") !== "true";
      press(button, on);
      groups[button.dataset.group].visible = on;
      draw();
    });
  }
  measuring.addEventListener("click", () => {
    press(measuring, measuring.getAttribute("aria-pressed") !== "true");
    picked.length = 0;
    readout.textContent = measuring.getAttribute("aria-pressed") === "true" ? "Click two points to measure between them." : "Click a point to read it.";
    show();
  });
  own.addEventListener("input", () => {
    const limit = Number(own.value);
    range = limit > 0 ? { limit, linear: null } : { limit: view.limit, linear: view.linear };
    paint();
  });
  const how = document.getElementById("cut");
  const where = document.getElementById("cut-at");
  const plane = new THREE.Plane();
  function section() {
    const share = Number(where.value);
    where.hidden = how.value === "none";
    cuts.length = 0;
    const words = document.getElementById("cut-words");
    words.textContent = "";
    if (how.value === "across") {
      const z = share * told.faceWidth;
      plane.set(new THREE.Vector3(0, 0, -1), z);
      words.textContent = `z = ${z.toFixed(2)} mm`;
    } else {
      const angle = 2 * Math.PI * share;
      plane.set(new THREE.Vector3(-Math.sin(angle), Math.cos(angle), 0), 0);
      words.textContent = how.value === "along" ? `${((360 * share) % 360).toFixed(1)}°` : "";
    }
    if (how.value !== "none") cuts.push(plane);
    for (const group of Object.values(groups)) for (const drawn of group.children) drawn.material.needsUpdate = true;
    draw();
  }
  how.addEventListener("change", section);
  where.addEventListener("input", section);
  document.getElementById("home").addEventListener("click", home);
  paint();
  window.gearView = { camera, groups, under, cuts, picked }; // for a console, and for tests
})();
