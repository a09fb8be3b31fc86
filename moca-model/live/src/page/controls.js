// What the person at the page does: leads people, switches faults, begins anew.

const UPRIGHT = { way: "stand", speed: 0.5, facing: "robot", activity: "walk", tool: "drill", lean: 0, squat: 0, reach: "work" };
const SOUND = { noise: 1, lost: 0.02, latency: 0, occluded: false, payload: 0, cable: false, measurements: false, slip: 0 };
const TASKS = [
  ["empty hands", { activity: "walk" }],
  ["carry", { activity: "carry" }],
  ["offer", { activity: "deliver" }],
  ["hold drill", { activity: "hold", tool: "drill" }],
  ["use drill", { activity: "use", tool: "drill" }],
  ["use polisher", { activity: "use", tool: "polisher" }],
];
const REACHES = [["hand at work", "work"], ["arm straight", "ahead"], ["hand between", "between"]];
const FACINGS = [["face the robot", "robot"], ["face the way", "way"]];
const MOVEMENTS = ["bow", "kneel", "sit-down", "lean-sideways", "reach-overhead", "turn", "squat", "pick-up", "step-sideways", "swing-arms"];
const STEPS = { ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };
const TURNS = { ",": 1, ".": -1 };

class Controls {
  constructor(link, camera) {
    Object.assign(this, { link, camera, who: "worker", keys: new Set(), choices: [] });
    this.leads = { worker: { ...UPRIGHT, way: { to: [1.45, 0] }, activity: "use" }, bystander: { ...UPRIGHT } };
    this.faults = { ...SOUND, push_tool: [0, 0, 0], push_elbow: [0, 0, 0] };
    this.sliders = {};
    this.addPerson(document.getElementById("person"));
    this.addRobot(document.getElementById("robot"));
    this.addFaults(document.getElementById("faults"));
    this.addAgain(document.getElementById("again"));
    this.listen();
    this.mark();
  }

  /** Somebody does this besides what they do. */
  lead(who, change) {
    Object.assign(this.leads[who], change);
    this.number = this.link.ask("lead", { who, ...this.leads[who] });
    this.mark();
  }

  fail(change) {
    Object.assign(this.faults, change);
    this.number = this.link.ask("faults", this.faults);
    this.mark();
  }

  again(change) {
    this.link.ask("restart", change);
    Object.assign(this.leads, { worker: { ...UPRIGHT, way: { to: [1.45, 0] }, activity: change.hands_over ? "carry" : "use" }, bystander: { ...UPRIGHT } });
    Object.assign(this.faults, SOUND);
    this.who = "worker";
    this.mark();
  }

  row(parent) {
    return html("div", { class: "controls" }, parent);
  }

  button(parent, text, action, pressed) {
    const button = html("button", { type: "button", text }, parent);
    button.addEventListener("click", action);
    if (pressed) this.choices.push({ button, pressed });
    return button;
  }

  slider(parent, name, [min, max, step], unit, value, changed) {
    const label = html("label", { class: "slider" }, parent);
    html("span", { text: name }, label);
    const input = html("input", { type: "range", min, max, step, id: `slider-${name.replace(/\W+/g, "-")}` }, label);
    const output = html("output", {}, label);
    const show = () => (output.textContent = `${Number(input.value)} ${unit}`);
    input.addEventListener("input", () => {
      show();
      changed(Number(input.value));
    });
    this.sliders[name] = (now) => {
      if (document.activeElement !== input || Number(input.value) !== now) input.value = now;
      show();
    };
    this.sliders[name](value);
  }

  addPerson(parent) {
    const people = this.row(parent);
    for (const who of ["worker", "bystander"]) {
      const name = who === "worker" ? "who works" : "second person";
      this.button(people, name, () => {
        this.who = who;
        if (who === "bystander" && !this.bystander) this.link.ask("bystander", { on: true });
        this.mark();
      }, () => this.who === who);
    }
    this.button(people, "send away", () => {
      this.link.ask("bystander", { on: false });
      this.who = "worker";
      this.mark();
    });
    const own = () => this.leads[this.who];
    const choose = (choices, change, pressed) => {
      const row = this.row(parent);
      for (const [text, value] of choices) this.button(row, text, () => this.lead(this.who, change(value)), () => pressed(value));
    };
    choose(TASKS, (task) => task, (task) => Object.entries(task).every(([key, value]) => own()[key] === value));
    choose(REACHES, (reach) => ({ reach }), (reach) => own().reach === reach);
    choose(FACINGS, (facing) => ({ facing }), (facing) => own().facing === facing);
    this.slider(parent, "walking speed", [0.1, 1.2, 0.05], "m/s", 0.5, (speed) => this.lead(this.who, { speed }));
    this.slider(parent, "lean", [0, 1.2, 0.02], "rad", 0, (lean) => this.lead(this.who, { lean }));
    this.slider(parent, "squat", [0, 0.2, 0.01], "statures", 0, (squat) => this.lead(this.who, { squat }));
    const row = this.row(parent);
    for (const movement of MOVEMENTS) {
      this.button(row, movement.replace("-", " "), () => this.link.ask("move", { who: this.who, movement }));
    }
  }

  addRobot(parent) {
    const row = this.row(parent);
    const on = () => this.picture?.ergonomics ?? true;
    this.button(row, "Ergonomics", () => this.link.ask("ergonomics", { on: !on() }), on);
    const beside = () => Boolean(this.picture?.beside);
    this.button(row, "Both runs", () => this.link.ask("beside", { on: !beside() }), beside);
    this.button(row, "Stop", () => this.link.ask("stop"));
    this.acknowledge = this.button(row, "Acknowledge, and go on", () => this.link.ask("acknowledge"));
  }

  addFaults(parent) {
    const row = this.row(parent);
    for (const [text, key] of [["occlusion", "occluded"], ["cable pulled", "cable"], ["measurements cut", "measurements"]]) {
      this.button(row, text, () => this.fail({ [key]: !this.faults[key] }), () => this.faults[key]);
    }
    this.button(row, "all well", () => this.fail(SOUND));
    this.slider(parent, "camera noise", [0, 5, 0.1], "×", 1, (noise) => this.fail({ noise }));
    this.slider(parent, "joints lost", [0, 1, 0.01], "", 0.02, (lost) => this.fail({ lost }));
    this.slider(parent, "latency", [0, 1, 0.05], "s", 0, (latency) => this.fail({ latency }));
    this.slider(parent, "payload", [0, 5, 0.1], "kg", 0, (payload) => this.fail({ payload }));
    this.slider(parent, "wheels slip", [0, 0.5, 0.01], "", 0, (slip) => this.fail({ slip }));
  }

  addAgain(parent) {
    let stature = 1.75;
    this.slider(parent, "stature", [1.4, 2.1, 0.01], "m", stature, (value) => (stature = value));
    const row = this.row(parent);
    this.button(row, "Begin anew", () => this.again({ stature, hands_over: false }));
    this.button(row, "Begin with a hand-over", () => this.again({ stature, hands_over: true }));
    const paper = () => this.levels === "paper";
    this.button(row, "The paper's three levels", () => this.again({ levels: paper() ? "extended" : "paper" }), paper);
    const saves = this.row(parent);
    saves.append("Save: ");
    for (const [text, href] of [["recording", "/recording.jsonl"], ["truth", "/truth.jsonl"], ["settings", "/settings.toml"]]) {
      html("a", { href, download: "", text }, saves);
    }
    html("p", { text: "The last five minutes: follow --recording live.jsonl --truth live-truth.jsonl --settings live.toml" }, parent);
    const details = html("details", {}, parent);
    html("summary", { text: "Settings, with what they mean" }, details);
    this.settings = html("textarea", { spellcheck: "false", "aria-label": "Settings" }, details);
    this.button(this.row(details), "Begin anew with these", () => this.again({ settings: this.settings.value }));
  }

  /** A new workcell. */
  greet(hello) {
    this.settings.value = hello.settings;
    this.levels = hello.levels;
    this.sliders.stature(hello.stature);
    this.mark();
  }

  see(picture) {
    const before = this.picture;
    this.picture = picture;
    this.bystander = Boolean(picture.bystander);
    this.acknowledge.disabled = !picture.waits && !picture.stopped;
    if (before?.ergonomics !== picture.ergonomics || Boolean(before?.beside) !== Boolean(picture.beside)) this.mark();
  }

  mark() {
    for (const { button, pressed } of this.choices) button.setAttribute("aria-pressed", String(Boolean(pressed())));
    const { speed, lean, squat } = this.leads[this.who];
    const { noise, lost, latency, payload, slip } = this.faults;
    const shown = { "walking speed": speed, lean, squat, "camera noise": noise, "joints lost": lost, latency, payload, "wheels slip": slip };
    for (const [name, value] of Object.entries(shown)) this.sliders[name](value);
  }

  listen() {
    const inControl = (event) => event.target.closest?.("select, input, textarea, summary, a");
    document.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || inControl(event)) return;
      const { key } = event;
      if (!(key in STEPS) && !(key in TURNS) && key !== " ") return;
      if (key === " " && event.target.closest?.("button")) return;
      event.preventDefault();
      if (event.repeat) return;
      if (key === " ") this.lead(this.who, { way: "stand" });
      this.keys.add(key);
      this.walk();
    });
    document.addEventListener("keyup", (event) => {
      if (this.keys.delete(event.key)) this.walk();
    });
    window.addEventListener("blur", () => {
      if (this.keys.size === 0) return;
      this.keys.clear();
      this.walk();
    });
  }

  /** Walks as keys say. */
  walk() {
    const sum = [0, 0];
    let turn = 0;
    for (const key of this.keys) {
      STEPS[key]?.forEach((step, k) => (sum[k] += step));
      turn += TURNS[key] ?? 0;
    }
    this.go(sum, turn);
  }

  /** Walks to the right and away from the eye, and turns to the left. */
  go([right, away], turn) {
    const { turn: at } = this.camera;
    const along = [-Math.sin(at) * right - Math.cos(at) * away, Math.cos(at) * right - Math.sin(at) * away];
    const change = { way: Math.hypot(...along) > 0.05 ? { along } : "stand" };
    if (turn !== 0) change.facing = { turning: turn };
    else if (this.leads[this.who].facing.turning !== undefined) change.facing = { turning: 0 };
    this.lead(this.who, change);
  }

  /** The sticks of a gamepad, once a picture. */
  poll() {
    const pad = [...(navigator.getGamepads?.() ?? [])].find(Boolean);
    if (!pad) return;
    const stick = pad.axes.slice(0, 3).map((value) => (Math.abs(value) < 0.15 ? 0 : Math.round(value * 10) / 10));
    const [right, down, turn] = [stick[0] ?? 0, stick[1] ?? 0, stick[2] ?? 0];
    const text = [right, down, turn].join();
    if (this.stick === undefined || this.stick === text) {
      this.stick = text;
      return;
    }
    this.stick = text;
    const size = Math.min(Math.hypot(right, down), 1);
    if (size > 0) this.leads[this.who].speed = Math.max(0.1, Math.round(1.2 * size * 20) / 20);
    this.go([right, -down], -turn);
  }
}
