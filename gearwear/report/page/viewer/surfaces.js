"use strict";
// The surfaces of the scene: unpacked, drawn by WebGL 2, and met by a ray. A section [x, y, z, c] leaves what has x·px + y·py + z·pz + c ≥ 0.

const NOT_SEEN = -32768; // the value that stands for it
const BEHIND = { worn: 0, lost: -0.25, design: 0.5 }; // pixels: of surfaces in one place lost metal is seen before worn, design last
const LAMP = [-0.231, 0.416, 0.88]; // unit vector to it, from over the left shoulder: right, up, back

/** Base 64 to numbers, lowest byte first. */
function unpacked(kind, text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = letters.charCodeAt(i);
  return new { u2: Uint16Array, u4: Uint32Array, i2: Int16Array }[kind](bytes.buffer);
}

/** Faces that come so many times, each time of corners that lie so much further on. */
function repeated(once, { times, further }) {
  const faces = new Uint32Array(times * once.length);
  for (let i = 0; i < times; i++) for (let k = 0; k < once.length; k++) faces[i * once.length + k] = i * further + once[k];
  return faces;
}

/** A surface of the scene; its corners come as whole parts of the box. */
function unpackedSurface(packed, [low, high]) {
  const whole = unpacked("u2", packed.corners.data);
  const faces = repeated(unpacked(packed.faces.kind, packed.faces.data), packed.faces);
  const corners = new Float32Array(whole.length);
  for (let i = 0; i < whole.length; i++) corners[i] = low[i % 3] + ((high[i % 3] - low[i % 3]) / 65535) * whole[i];
  const values = {};
  for (const [key, value] of Object.entries(packed.values || {})) values[key] = { step: value.step, at: unpacked("i2", value.data) };
  const { name, group, colour, teeth, faceted } = packed;
  return { name, group, colour, teeth, faceted, corners, faces, values, normals: normals(corners, faces) };
}

/** Outward unit normals at the corners: means of the faces round them, by area. */
function normals(corners, faces) {
  const sums = new Float32Array(corners.length);
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [3 * faces[f], 3 * faces[f + 1], 3 * faces[f + 2]];
    const [ux, uy, uz] = [corners[b] - corners[a], corners[b + 1] - corners[a + 1], corners[b + 2] - corners[a + 2]];
    const [vx, vy, vz] = [corners[c] - corners[a], corners[c + 1] - corners[a + 1], corners[c + 2] - corners[a + 2]];
    const normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const at of [a, b, c]) for (let i = 0; i < 3; i++) sums[at + i] += normal[i];
  }
  for (let i = 0; i < sums.length; i += 3) {
    const length = Math.hypot(sums[i], sums[i + 1], sums[i + 2]) || 1;
    for (let k = i; k < i + 3; k++) sums[k] /= length;
  }
  return sums;
}

/** Micrometres of a view at every corner that were seen, by view. */
function readAt(surface, corner) {
  const seen = Object.entries(surface.values).filter(([, value]) => value.at[corner] !== NOT_SEEN);
  return Object.fromEntries(seen.map(([key, value]) => [key, value.step * value.at[corner]]));
}

/**
 * What a ray meets first of what the section leaves: `surface`, the `corner` of it that is nearest, `point`, and whether it is `cut`,
 * the plane of the section within metal; null for nothing.
 */
function met(surfaces, { origin, direction }, section) {
  const best = { depth: Infinity };
  for (const surface of surfaces) nearer(best, surface, origin, direction, section);
  if (!best.surface) return null;
  const { surface, face } = best;
  let depth = best.depth;
  // Metal seen from within: the ray came in through the section.
  const cut = Boolean(section && best.within);
  if (cut) depth = -(dot(section, origin) + section[3]) / dot(section, direction);
  const point = onward(origin, depth, direction);
  const away = (corner) => distance(point, surface.corners.subarray(3 * corner, 3 * corner + 3));
  const corner = [...surface.faces.subarray(face, face + 3)].reduce((one, other) => (away(other) < away(one) ? other : one));
  return { surface, corner, point, cut };
}

/** Put the nearest face of a surface into `best`, if it is nearer (Möller and Trumbore 1997). */
function nearer(best, surface, [ox, oy, oz], [dx, dy, dz], section) {
  const { corners, faces } = surface;
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
    const ux = corners[b] - corners[a], uy = corners[b + 1] - corners[a + 1], uz = corners[b + 2] - corners[a + 2];
    const vx = corners[c] - corners[a], vy = corners[c + 1] - corners[a + 1], vz = corners[c + 2] - corners[a + 2];
    const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
    const determinant = ux * px + uy * py + uz * pz; // positive where the ray comes from outside
    if (determinant === 0) continue;
    const sx = ox - corners[a], sy = oy - corners[a + 1], sz = oz - corners[a + 2];
    const u = (sx * px + sy * py + sz * pz) / determinant;
    if (u < 0 || u > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const v = (dx * qx + dy * qy + dz * qz) / determinant;
    if (v < 0 || u + v > 1) continue;
    const depth = (vx * qx + vy * qy + vz * qz) / determinant;
    if (depth <= 0 || depth >= best.depth) continue;
    if (section && dot(section, [ox + depth * dx, oy + depth * dy, oz + depth * dz]) + section[3] < 0) continue;
    Object.assign(best, { depth, surface, face: f, within: determinant < 0 });
  }
}

const VERTEX_SHADER = `#version 300 es
uniform mat4 camera;
uniform vec3 eye;
uniform float step, behind; // µm in one of the values; mm that the surface is drawn behind its place
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;
centroid out vec3 place, outward; // at a place within the triangle: a thin one's would else be anything
centroid out vec2 known; // µm, and 1 where they were seen
void main() {
  float seen = value > ${NOT_SEEN}.0 + 0.5 ? 1.0 : 0.0;
  known = seen * vec2(step * value, 1.0);
  place = corner;
  outward = normal;
  gl_Position = camera * vec4(corner + behind * normalize(corner - eye), 1.0);
}`;

const fragmentShader = (shades) => `#version 300 es
precision highp float;
uniform vec3 eye, lamp, plain, unseen, inside, shade[${shades}];
uniform vec4 section, range; // range: limit and linear part in µm (0: all is linear), low and high end of the scale
uniform bool cut, coloured, faceted, veil;
centroid in vec3 place, outward;
centroid in vec2 known;
out vec4 colour;

float asinhOf(float x) { return sign(x) * log(abs(x) + sqrt(x * x + 1.0)); } // that of the language loses digits below zero

vec3 onScale(float um) {
  float share = range.y > 0.0 ? asinhOf(um / range.y) / asinhOf(range.x / range.y) : um / range.x;
  float at = 0.5 * (clamp(share, range.z, range.w) + 1.0) * ${shades - 1}.0;
  int under = min(int(at), ${shades - 2});
  return mix(shade[under], shade[under + 1], at - float(under));
}

void main() {
  vec3 facet = cross(dFdx(place), dFdy(place)); // before any way out: neighbours are needed for it
  if (cut && dot(section.xyz, place) + section.w < 0.0) discard;
  vec3 ray = normalize(place - eye);
  float away = dot(normalize(outward), ray);
  // The nearest that is left is metal seen from within: there the section cuts it. Which way a triangle faces that is thinner than the
  // grid of the rasteriser is chance; normals tell, where they do not nearly stand across the ray.
  if (cut && !veil && (abs(away) > 0.3 ? away > 0.0 : !gl_FrontFacing)) {
    colour = vec4(inside, 1.0);
    return;
  }
  vec3 normal = normalize(faceted ? facet : faceforward(outward, ray, outward));
  vec3 base = coloured ? mix(unseen, onScale(known.x / max(known.y, 1e-6)), known.y) : plain;
  base *= 0.82 + 0.22 * max(dot(normal, lamp), 0.0); // little shade: colours must be found again in the legend
  colour = veil ? 0.22 * vec4(base, 1.0) : vec4(base, 1.0);
}`;

/** "#rrggbb" as three numbers up to 1. */
const rgb = (name) => [1, 3, 5].map((at) => parseInt(name.slice(at, at + 2), 16) / 255);

/** Draws surfaces on a canvas, for `colours` as in the scene. */
class Painter {
  /** Raises where the canvas has no WebGL 2. */
  constructor(canvas, surfaces, colours) {
    this.gl = canvas.getContext("webgl2", { antialias: true });
    if (!this.gl) throw new Error("no WebGL 2");
    Object.assign(this, { canvas, surfaces, colours });
    this.prepare();
  }

  /** Bring program and surfaces to the graphics processor: at first, and when it has lost them. */
  prepare() {
    const { gl, colours } = this;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, fragmentShader(colours.scale.length)]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    this.at = new Proxy({}, { get: (known, name) => (known[name] ??= gl.getUniformLocation(program, name)) });
    this.drawn = this.surfaces.map((surface) => this.bring(surface));
    gl.uniform3fv(this.at.shade, colours.scale.flatMap(rgb));
    gl.uniform3fv(this.at.unseen, rgb(colours.unseen));
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.clearColor(0, 0, 0, 0); // the page shows through
  }

  /** The buffers of one surface. */
  bring(surface) {
    const { gl } = this;
    const buffer = (target, data) => {
      const made = gl.createBuffer();
      gl.bindBuffer(target, made);
      gl.bufferData(target, data, gl.STATIC_DRAW);
      return made;
    };
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    for (const [location, data] of [surface.corners, surface.normals].entries()) {
      buffer(gl.ARRAY_BUFFER, data);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 0, 0);
    }
    buffer(gl.ELEMENT_ARRAY_BUFFER, surface.faces);
    const columns = Object.entries(surface.values).map(([key, value]) => [key, buffer(gl.ARRAY_BUFFER, new Float32Array(value.at))]);
    return { surface, array, values: Object.fromEntries(columns) };
  }

  /** Draw the shown groups as the camera sees them, with the values of a view coloured over a range. */
  draw(camera, { shown, view, range, section }) {
    const { gl, at, canvas } = this;
    const density = Math.min(devicePixelRatio, 2);
    const [width, height] = [Math.round(density * camera.width), Math.round(density * camera.height)];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(at.camera, false, camera.matrix);
    gl.uniform3fv(at.eye, camera.eye);
    const axes = [camera.right, camera.up, camera.back];
    gl.uniform3fv(at.lamp, axes.reduce((sum, axis, i) => onward(sum, LAMP[i], axis), [0, 0, 0]));
    gl.uniform1i(at.cut, section ? 1 : 0);
    gl.uniform4fv(at.section, section || [0, 0, 0, 0]);
    gl.uniform4f(at.range, range.limit, range.linear || 0, view.low, view.high);
    for (const veil of [false, true]) { // the design last, over all others
      gl.uniform1i(at.veil, veil ? 1 : 0);
      gl.depthMask(!veil);
      (veil ? gl.enable : gl.disable).call(gl, gl.BLEND);
      for (const one of this.drawn) {
        const { group } = one.surface;
        if ((group === "design") === veil && shown[group]) this.drawOne(one, view, camera.away / camera.scale);
      }
    }
    gl.depthMask(true);
  }

  drawOne({ surface, array, values }, view, pixel) {
    const { gl, at } = this;
    const known = surface.values[view.key];
    gl.bindVertexArray(array);
    if (known) {
      gl.bindBuffer(gl.ARRAY_BUFFER, values[view.key]);
      gl.enableVertexAttribArray(2);
      gl.vertexAttribPointer(2, 1, gl.FLOAT, false, 0, 0);
      gl.uniform1f(at.step, known.step);
    } else gl.disableVertexAttribArray(2);
    gl.uniform1f(at.behind, pixel * BEHIND[surface.group]);
    gl.uniform1i(at.coloured, known ? 1 : 0);
    gl.uniform1i(at.faceted, surface.faceted ? 1 : 0);
    gl.uniform3fv(at.plain, rgb(surface.colour));
    gl.uniform3fv(at.inside, rgb(surface.group === "worn" ? this.colours.inside : surface.colour));
    gl.drawElements(gl.TRIANGLES, surface.faces.length, gl.UNSIGNED_INT, 0);
  }
}
