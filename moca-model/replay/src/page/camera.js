// The eye: it looks at a target from a distance, and goes along with it.

const VIEWS = {
  corner: { turn: -0.9, rise: 0.42 },
  side: { turn: -Math.PI / 2, rise: 0.12 },
  top: { turn: -Math.PI / 2, rise: 1.5 },
  behind: { turn: Math.PI, rise: 0.35 },
};

/** The angle of the picture's height (rad). */
const ANGLE = 0.62;

class Camera {
  constructor() {
    this.follows = true;
    this.shift = [0, 0, 0];
    this.distance = 3.7;
    this.look("corner");
  }

  look(name) {
    Object.assign(this, VIEWS[name]);
    this.shift = [0, 0, 0];
  }

  orbit(right, up) {
    this.turn -= right;
    this.rise = Math.min(Math.max(this.rise + up, -0.1), 1.55);
  }

  /** Moves the target across the view by shares of its height. */
  pan(right, down) {
    const reach = this.distance * 0.75;
    const aside = [-Math.sin(this.turn), Math.cos(this.turn), 0];
    const ahead = [-Math.cos(this.turn), -Math.sin(this.turn), 0];
    this.shift = add(this.shift, scale(aside, -right * reach));
    const rise = Math.sin(this.rise);
    this.shift = add(this.shift, scale(ahead, down * reach * rise));
    this.shift[2] += down * reach * Math.cos(this.rise);
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.7), 14);
  }

  /** Where it stands, and the matrix from the world to the picture. */
  view(target, aspect) {
    const at = add(target, this.shift);
    const out = [
      Math.cos(this.turn) * Math.cos(this.rise),
      Math.sin(this.turn) * Math.cos(this.rise),
      Math.sin(this.rise),
    ];
    // On a narrow picture the width has to hold what the height holds otherwise.
    const distance = this.distance * Math.max(1, 1.25 / aspect);
    const eye = add(at, scale(out, distance));
    const up = this.rise > 1.4 ? [-Math.cos(this.turn), -Math.sin(this.turn), 0] : [0, 0, 1];
    const matrix = multiply(perspective(ANGLE, aspect, 0.1, 40), lookAt(eye, at, up));
    return { eye, target: at, matrix, up, aspect };
  }
}

/** Lets mouse, pen and fingers move a camera; `changed` is called when they do. */
function listenToPointers(canvas, camera, changed) {
  const pointers = new Map();
  const middle = () => {
    const all = [...pointers.values()];
    return [0, 1].map((k) => all.reduce((sum, p) => sum + p[k], 0) / all.length);
  };
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return b ? Math.max(Math.hypot(a[0] - b[0], a[1] - b[1]), 1) : 1;
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return;
    const [before, apart] = [middle(), spread()];
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    const [now, height] = [middle(), canvas.clientHeight];
    const [right, down] = [(now[0] - before[0]) / height, (now[1] - before[1]) / height];
    const pans = pointers.size > 1 || event.buttons & 6 || event.shiftKey;
    if (pans) camera.pan(right, down);
    else camera.orbit(right * 3.2, down * 3.2);
    if (pointers.size > 1) camera.zoom(apart / spread());
    changed();
  });
  for (const ends of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(ends, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      camera.zoom(Math.exp(event.deltaY * (event.deltaMode === 1 ? 0.03 : 0.0012)));
      changed();
    },
    { passive: false },
  );
}

/** How many pixels a picture takes for one of the screen, each way: a standing picture is sharp and smooth, a
 * moving one keeps up. */
class Quality {
  /** `target` is about how far apart pictures are to be (ms). */
  constructor(target = 20) {
    this.target = target;
    this.moving = 1;
    this.count = 0;
  }

  /** Takes note of a picture while it moves. */
  note(now) {
    const pictures = 10;
    this.count += 1;
    if (this.count < pictures) return;
    const took = (now - (this.since ?? -Infinity)) / pictures;
    Object.assign(this, { since: now, count: 0 });
    const share = took / this.target;
    if (share > 1.2 && took < 500) this.moving = Math.max(0.35, this.moving * (share > 2 ? 0.7 : 0.88));
    else if (share < 0.9) this.moving = Math.min(Quality.sharp, this.moving * 1.04);
  }

  static sharp = 2;
}
