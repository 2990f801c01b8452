"use strict";
// Where the eye is, what it sees of a point, and what mouse, fingers and keys do to it. Points in mm; places on the canvas in CSS pixels
// from its upper left corner. z, the axis of the gear, points up.

const FIELD_OF_VIEW = (28 * Math.PI) / 180; // from the top of the canvas to its bottom
const NEAREST = 0.05, FARTHEST = 30; // of the eye from what it looks at, in radii of the scene
const TURN_BY_KEY = Math.PI / 36, PAN_BY_KEY = 30, ZOOM_BY_KEY = 1.15, ZOOM_BY_WHEEL = 0.0012; // rad, px, factor, its logarithm per px
const TAP = 4; // px that a click may move

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
/** The place reached from `start` by going so many times `direction`. */
const onward = (start, times, direction) => [0, 1, 2].map((i) => start[i] + times * direction[i]);
const within = (value, low, high) => Math.min(Math.max(value, low), high);

/** A camera that goes round a target and always holds the gear's axis upright. */
class Camera {
  /** `middle` and `radius` of a ball that holds all there is to see. */
  constructor(middle, radius) {
    Object.assign(this, { middle, radius, target: middle, away: 4 * radius, azimuth: 0, elevation: 0 });
    Object.assign(this, { width: 1, height: 1, aside: 0 }); // the canvas; px by which the target stands left of its middle
  }

  /** Look at the middle from this direction. */
  look(direction, away) {
    this.target = this.middle;
    this.away = away;
    this.azimuth = Math.atan2(direction[1], direction[0]);
    this.elevation = Math.atan2(direction[2], Math.hypot(direction[0], direction[1]));
  }

  // Unit vectors: from the target to the eye, to the right and to the top of the canvas; they hold straight above the gear, too.
  get back() {
    const level = Math.cos(this.elevation);
    return [level * Math.cos(this.azimuth), level * Math.sin(this.azimuth), Math.sin(this.elevation)];
  }
  get right() {
    return [-Math.sin(this.azimuth), Math.cos(this.azimuth), 0];
  }
  get up() {
    return cross(this.back, this.right);
  }
  get eye() {
    return onward(this.target, this.away, this.back);
  }
  /** Pixels of one millimetre that is one millimetre away. */
  get scale() {
    return (0.5 * this.height) / Math.tan(0.5 * FIELD_OF_VIEW);
  }

  /** Where a point is seen, and how far in front of the eye, in mm; behind it where that is negative. */
  project(point) {
    const from = minus(point, this.eye);
    const depth = -dot(from, this.back);
    const size = this.scale / depth;
    return { x: 0.5 * this.width - this.aside + size * dot(from, this.right), y: 0.5 * this.height - size * dot(from, this.up), depth };
  }

  /** What is seen at a place: all points `onward(origin, depth, direction)`. */
  ray(x, y) {
    const sideways = onward([0, 0, 0], (x - 0.5 * this.width + this.aside) / this.scale, this.right);
    return { origin: this.eye, direction: minus(onward(sideways, (0.5 * this.height - y) / this.scale, this.up), this.back) };
  }

  /** The same for WebGL: a point and 1 to clip coordinates, by columns. Near and far planes touch the ball. */
  get matrix() {
    const { eye, scale } = this;
    const row = (axis, factor) => [...axis, -dot(eye, axis)].map((part) => factor * part);
    const across = row(this.right, (2 * scale) / this.width);
    const upward = row(this.up, (2 * scale) / this.height);
    const depth = row(this.back, -1);
    const apart = distance(eye, this.middle);
    const near = Math.max(apart - 1.1 * this.radius, 0.02 * NEAREST * this.radius);
    const far = apart + 1.1 * this.radius;
    const columns = [0, 1, 2, 3].map((i) => {
      const deep = (depth[i] * (far + near) - (i === 3 ? 2 * far * near : 0)) / (far - near);
      return [across[i] - ((2 * this.aside) / this.width) * depth[i], upward[i], deep, depth[i]];
    });
    return new Float32Array(columns.flat());
  }

  /** Go round the target, rad. */
  turn(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = within(this.elevation + elevation, -0.5 * Math.PI, 0.5 * Math.PI);
  }

  /** Shift what is seen, px to the right and down. */
  pan(right, down) {
    const size = this.away / this.scale; // mm of a pixel at the target
    const target = onward(onward(this.target, -size * right, this.right), size * down, this.up);
    const out = distance(target, this.middle);
    this.target = onward(this.middle, Math.min(1, (1.5 * this.radius) / (out || 1)), minus(target, this.middle));
  }

  /** Come nearer (below 1) or go away; what is seen at this place stays there. */
  zoom(factor, x = 0.5 * this.width - this.aside, y = 0.5 * this.height) {
    const away = within(this.away * factor, NEAREST * this.radius, FARTHEST * this.radius);
    const rest = 1 - away / this.away;
    this.pan(rest * (0.5 * this.width - this.aside - x), rest * (0.5 * this.height - y));
    this.away = away;
  }
}

/**
 * Let the camera follow mouse, fingers and keys.
 *
 * One finger or the left button turns; two fingers pinch and pan; the right or middle button, or Shift, pans; the wheel zooms.
 * Arrows turn, with Shift pan; + and − zoom; Home goes home; Enter taps the middle. `acts` has changed(), home() and tapped(x, y).
 */
function steer(canvas, camera, acts) {
  const down = new Map(); // fingers, or the mouse: by their numbers, where each is
  let start = null; // where a tap began; null once it is none
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  /** Middle of what is down, and how far two fingers are apart. */
  const grip = () => {
    const [one, other = one] = [...down.values()];
    return { x: 0.5 * (one[0] + other[0]), y: 0.5 * (one[1] + other[1]), apart: Math.hypot(one[0] - other[0], one[1] - other[1]) };
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, place(event));
    start = down.size === 1 && event.button === 0 ? place(event) : null;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!down.has(event.pointerId)) return;
    const before = grip();
    down.set(event.pointerId, place(event));
    const now = grip();
    if (start && Math.hypot(now.x - start[0], now.y - start[1]) > TAP) start = null;
    const [right, low] = [now.x - before.x, now.y - before.y];
    if (down.size === 1 && event.buttons === 1 && !event.shiftKey) {
      const rate = (2 * Math.PI) / camera.height;
      camera.turn(-rate * right, rate * low);
    } else camera.pan(right, low);
    if (down.size > 1 && now.apart > 0) camera.zoom(before.apart / now.apart, now.x, now.y);
    acts.changed();
  });
  canvas.addEventListener("pointerup", (event) => {
    if (start && down.has(event.pointerId)) acts.tapped(...place(event));
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
    canvas.addEventListener(end, (event) => {
      down.delete(event.pointerId);
      start = null;
    });
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault()); // the right button pans
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault(); // the page stays where it is
      const pixels = event.deltaY * [1, 30, 400][event.deltaMode]; // of pixels, lines or pages
      camera.zoom(Math.exp(ZOOM_BY_WHEEL * within(pixels, -400, 400)), ...place(event));
      acts.changed();
    },
    { passive: false },
  );
  const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const KEYS = {
    "+": () => camera.zoom(1 / ZOOM_BY_KEY),
    "=": () => camera.zoom(1 / ZOOM_BY_KEY), // + without Shift
    "-": () => camera.zoom(ZOOM_BY_KEY),
    Home: acts.home,
    Enter: () => acts.tapped(0.5 * camera.width - camera.aside, 0.5 * camera.height),
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = ARROWS[event.key];
    if (!arrow && !KEYS[event.key]) return;
    event.preventDefault();
    if (!arrow) KEYS[event.key]();
    else if (event.shiftKey) camera.pan(PAN_BY_KEY * arrow[0], PAN_BY_KEY * arrow[1]);
    else camera.turn(-TURN_BY_KEY * arrow[0], TURN_BY_KEY * arrow[1]); // as if the gear were dragged that way
    acts.changed();
  });
}
