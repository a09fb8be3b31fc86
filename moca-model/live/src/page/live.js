// Puts the page together: pictures that come, and what is grabbed in them.

/** About how far apart pictures are (ms): somewhat more than the loop sends them. */
const PICTURES = 36;
/** The robot of the other run. */
const SHADOW = [0.55, 0.6, 0.75, 1];
/** Where the robot can be pushed: its frames. */
const HANDLES = { push_tool: "tool", push_elbow: "panda_link4" };
/** How near the pointer has to be to one of them (pixels), and aside of a person. */
const NEAR_TOOL = 34;
const NEAR_PERSON = 46;
/** About as tall are people (m). */
const TALL = 1.8;
/** Force for a drag by a metre, and at most (N). */
const PULL = 150;
const MOST_PULL = 60;

/** Where the line from the eye through a point of the picture, 0 to 1, meets a height; none above the horizon. */
function atHeight(view, x, y, height) {
  const back = unit(subtract(view.eye, view.target));
  const right = unit(cross(view.up, back));
  const above = cross(back, right);
  const reach = Math.tan(ANGLE / 2);
  const aside = scale(right, (2 * x - 1) * reach * view.aspect);
  const way = add(subtract(aside, back), scale(above, (1 - 2 * y) * reach));
  const share = (height - view.eye[2]) / way[2];
  return share > 0 && share < 60 ? add(view.eye, scale(way, share)) : null;
}

class Live {
  constructor() {
    this.byId = (id) => document.getElementById(id);
    this.camera = new Camera();
    this.quality = new Quality(PICTURES);
    this.theme = readTheme();
    this.shown = { person: true, posture: false, workspace: true, tool: true, distance: true, map: "" };
    Object.assign(this, { waiting: [], asked: new Map(), lags: [], times: [], rate: 0, lag: 0, pictures: 0, errors: [] });
    this.link = new Link((message) => this.hear(message), () => this.lose());
    // Before the view turns.
    this.listenToGrabs(this.byId("view"));
    listenToPointers(this.byId("view"), this.camera, () => (this.moved = true));
    this.controls = new Controls(this.link, this.camera);
    this.readings = new Readings(this.byId("readings"), this.byId("state"));
    this.guide = new Guide(this.byId("guide"), this.controls);
    this.addButtons();
    requestAnimationFrame((now) => this.turn(now));
  }

  hear(message) {
    if (message.kind === "picture") this.waiting.push({ picture: message, sent: this.link.sent });
    else if (message.kind === "hello") this.begin(message);
    else if (message.kind === "role") {
      this.link.steers = message.steers;
      this.say(message.steers ? "" : "Another page steers; this one watches.");
    } else if (message.kind === "error") {
      this.errors.push(message.error);
      this.say(message.error, 6000);
    }
  }

  lose() {
    this.say("The program has ended, or does not answer.");
    this.waiting = [];
    this.asked.clear();
  }

  say(text, time) {
    const notice = this.byId("notice");
    notice.textContent = text;
    clearTimeout(this.quiet);
    if (time) this.quiet = setTimeout(() => (notice.textContent = ""), time);
  }

  /** A workcell begins. */
  begin(hello) {
    this.head = hello.number;
    this.page = hello.page;
    this.run = new LiveRun(hello.page.runs[0]);
    this.other = new LiveRun(hello.page.runs[0]);
    this.scene = new Scene(this.page);
    try {
      this.renderer ??= new Renderer(this.byId("view"), this.page.map);
      this.renderer.loadMap(this.page.map);
    } catch (error) {
      this.byId("flat").textContent = `No picture in three dimensions: ${error.message}. All else works.`;
    }
    this.controls.greet(hello);
  }

  turn(now) {
    requestAnimationFrame((next) => this.turn(next));
    this.controls.poll();
    this.sendGrab();
    const { waiting } = this;
    if (waiting.length === 0 && !this.moved) return;
    this.waiting = [];
    for (const { picture } of waiting) {
      if (picture.head !== this.head) continue;
      this.picture = picture;
      this.run.push(picture);
      if (picture.beside) this.other.samples.push(picture.time, picture.beside.row);
      this.readings.note(this.run);
    }
    if (!this.picture) return;
    this.draw();
    for (const { picture } of waiting) this.link.ask("drawn", { picture: picture.number });
    this.note(performance.now());
    if (now - (this.read ?? 0) > 120) {
      this.read = now;
      this.controls.see(this.picture);
      this.readings.show(this.picture, this.run, this.other, this);
      this.guide.look(this.picture);
    }
    this.moved = false;
  }

  draw() {
    const { picture, run, camera } = this;
    const canvas = this.byId("view");
    if (!this.renderer) return;
    this.renderer.fit(this.quality.moving);
    if (!this.grab && camera.follows) this.target = this.smooth(this.scene.target(run, picture.time));
    this.target ??= this.scene.target(run, picture.time);
    this.view = camera.view(this.target, canvas.clientWidth / Math.max(canvas.clientHeight, 1));
    this.scene.build(run, picture.time, this.shown, this.theme);
    if (picture.beside) this.scene.addSolids(this.other, this.other.samples.locate(picture.time), SHADOW);
    this.renderer.draw(this.scene, this.view, this.theme);
    showLabels(this.byId("labels"), this.scene.labels, this.view);
  }

  /** The eye goes along without haste. */
  smooth(target) {
    if (!this.target) return target;
    const left = subtract(target, this.target);
    // How far it is behind, for who waits for it.
    this.still = norm(left);
    return add(this.target, scale(left, 0.06));
  }

  /** Takes note of a picture that was drawn. */
  note(now) {
    this.pictures += 1;
    this.quality.note(now);
    this.times.push(now);
    while (now - this.times[0] > 2000) this.times.shift();
    this.rate = (1000 * (this.times.length - 1)) / Math.max(now - this.times[0], 1);
    for (const [number, sent] of this.asked) {
      if (number > this.picture.heard) continue;
      this.asked.delete(number);
      this.lags.push(now - sent);
    }
    if (this.lags.length > 500) this.lags.shift();
    const sorted = [...this.lags].sort((a, b) => a - b);
    this.lag = sorted[Math.floor(0.95 * sorted.length)] ?? 0;
  }

  /** Sends where what is grabbed is to be, once a picture. */
  sendGrab() {
    const { grab } = this;
    if (!grab?.changed) return;
    grab.changed = false;
    if (grab.kind in HANDLES) this.controls.fail({ [grab.kind]: grab.force });
    else this.controls.lead(grab.kind, { way: { to: grab.place } });
    if (this.controls.number) this.asked.set(this.controls.number, grab.at);
  }

  /** Where a point is seen on the canvas (pixels); none behind the eye. */
  pixels(point) {
    const canvas = this.byId("view");
    const seen = seenAt(this.view.matrix, point);
    return seen && [seen[0] * canvas.clientWidth, seen[1] * canvas.clientHeight];
  }

  /** What is under the pointer: a handle of the robot, a person, or nothing. */
  under(x, y) {
    if (!this.view || !this.picture) return null;
    const pixels = (point) => this.pixels(point);
    for (const [kind, frame] of Object.entries(HANDLES)) {
      const place = this.run.place(frame);
      const at = pixels(place);
      if (at && Math.hypot(at[0] - x, at[1] - y) < NEAR_TOOL) return { kind, floor: place, height: place[2] };
    }
    for (const [kind, floor] of [["worker", this.picture.floor], ["bystander", this.picture.bystander]]) {
      if (!floor) continue;
      const [feet, head] = [pixels([floor[0], floor[1], 0]), pixels([floor[0], floor[1], TALL])];
      if (!feet || !head) continue;
      const share = Math.min(Math.max((feet[1] - y) / Math.max(feet[1] - head[1], 1), 0), 1);
      const middle = feet[0] + share * (head[0] - feet[0]);
      const hit = Math.abs(middle - x) < NEAR_PERSON && y > head[1] - 20 && y < feet[1] + 25;
      if (hit) return { kind, floor, height: share * TALL };
    }
    return null;
  }

  listenToGrabs(canvas) {
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    const point = ([x, y], height) => atHeight(this.view, x / canvas.clientWidth, y / canvas.clientHeight, height);
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || event.shiftKey) return;
      const [x, y] = place(event);
      const found = this.under(x, y);
      if (!found) return;
      event.stopImmediatePropagation();
      event.preventDefault();
      canvas.focus();
      canvas.setPointerCapture(event.pointerId);
      const { kind, floor, height } = found;
      const from = point([x, y], height);
      this.grab = { kind, pointer: event.pointerId, height, from, floor: floor.slice(0, 2) };
      if (!(kind in HANDLES)) {
        this.controls.who = kind;
        this.controls.mark();
      }
    });
    canvas.addEventListener("pointermove", (event) => {
      const { grab } = this;
      if (grab?.pointer !== event.pointerId) return;
      event.stopImmediatePropagation();
      const now = point(place(event), grab.height);
      if (!now || !grab.from) return;
      const moved = [now[0] - grab.from[0], now[1] - grab.from[1]];
      grab.place = [0, 1].map((k) => Math.min(Math.max(grab.floor[k] + moved[k], -15), 15));
      const pull = Math.min(PULL, MOST_PULL / Math.max(Math.hypot(...moved), 1e-6));
      grab.force = [moved[0] * pull, moved[1] * pull, 0];
      if (!grab.changed) grab.at = performance.now();
      grab.changed = true;
    });
    for (const ends of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(ends, (event) => {
        if (this.grab?.pointer !== event.pointerId) return;
        event.stopImmediatePropagation();
        this.sendGrab();
        if (this.grab.kind in HANDLES) this.controls.fail({ [this.grab.kind]: [0, 0, 0] });
        this.grab = null;
      });
    }
  }

  addButtons() {
    const press = (button, pressed) => button.setAttribute("aria-pressed", String(Boolean(pressed)));
    const toggles = [...document.querySelectorAll("[data-show]")];
    const mark = () => {
      for (const button of toggles) {
        const what = button.dataset.show;
        press(button, what === "follow" ? this.camera.follows : this.shown[what]);
        if (what === "map") button.textContent = this.shown.map ? `Map: ${this.shown.map}` : "Map";
      }
      this.moved = true;
    };
    for (const button of toggles) {
      button.addEventListener("click", () => {
        const what = button.dataset.show;
        const kinds = ["", "level", "upright"];
        if (what === "follow") this.camera.follows = !this.camera.follows;
        else if (what === "map") this.shown.map = kinds[(kinds.indexOf(this.shown.map) + 1) % kinds.length];
        else this.shown[what] = !this.shown[what];
        mark();
      });
    }
    for (const button of document.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => {
        this.camera.look(button.dataset.view);
        this.moved = true;
      });
    }
    this.byId("theme").addEventListener("click", () => {
      document.documentElement.dataset.theme = isDark() ? "light" : "dark";
      this.theme = readTheme();
      this.moved = true;
    });
    mark();
  }
}

// Under a name, for tests and for the curious.
window.live = new Live();
