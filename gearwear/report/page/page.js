"use strict";
(() => {
  const packed = document.getElementById("scene");
  const place = document.getElementById("view");
  const webgl = (() => {
    try {
      const canvas = document.createElement("canvas");
      return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
    } catch {
      return false;
    }
  })();
  if (!packed || !webgl) return; // the still picture stays
  const scene = JSON.parse(packed.textContent);
  document.documentElement.classList.add("drawn");
  const options = {
    displaylogo: false,
    responsive: true,
    scrollZoom: true,
    plotlyServerURL: "", // nothing leaves this page
    modeBarButtons: [["orbitRotation", "pan3d", "zoom3d", "resetCameraLastSave3d", "toImage"]],
  };
  if (place.clientWidth < 560) { // a phone: the legend lies below, the gear has the whole width, fingers need no buttons
    const view = scene.layout.scene;
    view.domain = { x: [0, 1], y: [0.18, 1] };
    for (const axis of "xyz") view.camera.eye[axis] *= 1.2;
    for (const trace of scene.data.filter((trace) => trace.colorbar)) {
      const title = { text: "deviation, µm: − missing, + too much", side: "top" };
      Object.assign(trace.colorbar, { title, orientation: "h", x: 0.5, xanchor: "center", y: 0, yanchor: "bottom", len: 0.94 });
    }
    options.displayModeBar = false;
  }
  Plotly.newPlot(place, scene.data, scene.layout, options).then(() => place.setAttribute("data-ready", "yes"));

  for (const button of document.querySelectorAll(".bar button")) {
    button.addEventListener("click", () => {
      const on = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(on));
      const group = scene.groups[button.dataset.group];
      if (group.length) Plotly.restyle(place, { visible: on }, group);
    });
  }

  const readout = document.getElementById("readout");
  const signed = (value) => (value < 0 ? "−" : "+") + Math.abs(value).toFixed(1);
  place.on("plotly_click", (event) => {
    const point = event.points[0];
    const [tooth, radius, deviation] = point.customdata || [];
    if (tooth === undefined) return;
    const said = [`tooth ${tooth}`, point.data.name];
    const r = radius === undefined ? Math.hypot(point.x, point.y) : radius;
    said.push(`r ${r.toFixed(3)} mm`, `z ${point.z.toFixed(3)} mm`);
    readout.textContent = "Picked: " + said.join(" · ");
    if (deviation !== undefined) {
      const strong = document.createElement("b");
      strong.textContent = ` · deviation ${signed(deviation)} µm`;
      readout.append(strong);
    }
  });
})();
