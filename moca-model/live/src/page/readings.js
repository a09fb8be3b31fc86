// What the controller thinks, in words and numbers.

const PARTS = ["neck", "trunk", "legs", "upper arm", "lower arm", "wrist"];
const SHOWN_LIMITS = 5;
const UNSCORED = [0.85, 0.87, 0.89];

class Readings {
  constructor(parent, badges) {
    this.badges = badges;
    const table = html("tbody", {}, html("table", {}, parent));
    const line = (name) => {
      const row = html("tr", {}, table);
      html("th", { scope: "row", text: name }, row);
      return html("td", { id: `reading-${name.replace(/\W+/g, "-")}` }, row);
    };
    const names = ["phase", "intention", "safety", "base", "solver", "e_s, hand at the tool", "REBA, true posture"];
    const more = ["the other run", "distance", "levels", "calmness", "tool in the workspace", "judged by the truth", "loop", "page"];
    this.cells = Object.fromEntries([...names, ...more].map((name) => [name, line(name)]));
    html("h2", { text: "Limits in use" }, parent);
    this.gauges = Array.from({ length: SHOWN_LIMITS }, () => {
      const gauge = html("div", { class: "gauge" }, parent);
      return { gauge, name: html("span", {}, gauge), bar: html("i", {}, gauge), share: html("span", {}, gauge) };
    });
    this.shares = [];
  }

  /** Keeps the greatest use of each limit since it was shown. */
  note(run) {
    const { limits } = run.samples.groups;
    const last = run.samples.count - 1;
    limits.columns.forEach((_, k) => {
      this.shares[k] = Math.max(this.shares[k] ?? 0, limits.get(last, k) || 0);
    });
  }

  show(picture, run, other, page) {
    const text = (name, words) => {
      const cell = this.cells[name];
      if (cell.textContent !== words) cell.textContent = words;
    };
    const states = ["phase", "intention", "safety"].map((name) => picture[name]);
    const labels = states.map((state) => state.label).join();
    if (this.labels !== labels) {
      this.labels = labels;
      this.badges.replaceChildren();
      for (const state of states) html("span", { class: `badge ${state.tone}`, text: state.label }, this.badges);
    }
    const number = (name, digits = 2) => written(run.now(name), digits);
    text("phase", `${picture.phase.label} (${picture.since.label})`);
    text("intention", picture.intention.label);
    text("safety", picture.safety.label + (picture.waits ? ", waits to be acknowledged" : ""));
    text("base", picture.base.label);
    text("solver", picture.solver.label);
    const score = run.now("e_s");
    const colour = Number.isNaN(score) ? UNSCORED : scoreColour(score);
    this.chip("e_s, hand at the tool", number("e_s"), colour, `ergonomics ${picture.ergonomics ? "on" : "off"}, share ${number("share of ergonomics")}`);
    const { parts } = run.person.groups;
    const scores = PARTS.map((name, k) => `${name} ${written(parts.get(run.person.count - 1, k), 0)}`);
    this.chip("REBA, true posture", picture.reba ?? "–", picture.reba ? rebaColour(picture.reba) : UNSCORED, scores.join(", "));
    const { beside } = picture;
    const choice = `ergonomics ${picture.ergonomics ? "off" : "on"}`;
    const there = beside && `e_s ${written(other.now("e_s"), 2)}, REBA ${beside.reba ?? "–"}, ${written(1e3 * beside.calm, 1)} mm/s, ${choice}`;
    text("the other run", there ?? "–");
    const pair = picture.pair ? `, ${picture.pair[0]} and ${picture.pair[1]}` : "";
    text("distance", `${number("monitored distance")} m of ${number("protective distance")} m protective${pair}`);
    text("levels", `pose ${written(1e3 * run.now("tracking error"), 1)} mm, workspace ${written(1e3 * run.now("slack of position"), 1)} mm, e_s ${number("e_s")}`);
    text("calmness", `the tool moves at ${written(1e3 * picture.calm, 1)} mm/s${picture.rests ? "; the frame is held" : ""}`);
    text("tool in the workspace", picture.grasps ? "with the object" : "with empty gripper");
    text("judged by the truth", `limits ${picture.limits}, too near ${picture.too_near}, not solved ${picture.unsolved}`);
    const { pace } = picture;
    text("loop", `tick ${pace.median.toFixed(0)} µs, 99 % ${pace.p99.toFixed(0)} µs; late ${((100 * pace.late) / pace.ticks).toFixed(1)} %, lost ${pace.lost}`);
    text("page", `${page.rate.toFixed(0)} pictures a second; from a message to its picture ${page.lag.toFixed(0)} ms`);
    this.showLimits(run);
  }

  chip(name, value, colour, words) {
    const cell = this.cells[name];
    if (!cell.firstChild) {
      html("span", { class: "chip" }, cell);
      cell.append(" ", document.createElement("span"));
    }
    const [chip, rest] = cell.children;
    chip.textContent = value;
    chip.style.background = css(colour);
    chip.style.color = inkOn(colour);
    rest.textContent = words;
  }

  showLimits(run) {
    const { columns } = run.samples.groups.limits;
    const order = columns.map((_, k) => k).sort((a, b) => (this.shares[b] ?? 0) - (this.shares[a] ?? 0));
    this.gauges.forEach(({ gauge, name, bar, share }, place) => {
      const k = order[place];
      const used = Math.min(this.shares[k] ?? 0, 1);
      name.textContent = columns[k] ?? "";
      bar.style.transform = `scaleX(${used})`;
      share.textContent = `${Math.round(100 * used)} %`;
      gauge.classList.toggle("bound", used > 0.99);
    });
    this.shares = [];
  }
}
