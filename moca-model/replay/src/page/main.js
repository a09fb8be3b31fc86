// Puts the page together.

/** Widths of a track's heading and of its plot on paper (pixels), as in media.css. */
const PAPER = { head: 110, plot: 580 };

class Viewer {
  constructor(page) {
    this.page = page;
    this.current = page.runs[0];
    this.shown = { person: true, posture: false, workspace: true, tool: true, distance: true, map: "" };
    this.camera = new Camera();
    this.axis = new TimeAxis(page.begin, page.end);
    this.player = new Player(page.begin, page.end, () => this.update());
    this.byId = (id) => document.getElementById(id);
    this.theme = readTheme();
    this.addStage();
    this.readAddress();
    this.moving = true;
    this.drawStage(this.player.time);
    // The picture is shown before the rest is made.
    requestAnimationFrame(() => setTimeout(() => this.addRest()));
  }

  addRest() {
    const { page } = this;
    this.addTracks();
    this.addControls();
    this.posture = new PosturePanel(this.byId("posture"), page);
    addResults(this.byId("result"), page);
    addLegend(this.byId("legend"));
    addHelp(this.byId("help"));
    this.complete = true;
    this.resize();
    new ResizeObserver(() => this.resize()).observe(this.byId("tracks"));
    new ResizeObserver(() => this.update()).observe(this.byId("stage"));
  }

  addStage() {
    const canvas = this.byId("view");
    this.scene = new Scene(this.page);
    this.quality = new Quality();
    try {
      this.renderer = new Renderer(canvas, this.page.map);
    } catch (error) {
      this.byId("stage").classList.add("flat");
      this.byId("flat").textContent =
        `No picture in three dimensions: ${error.message}. Plots and tables work.`;
    }
    listenToPointers(canvas, this.camera, () => this.update());
    canvas.addEventListener("webglcontextlost", () => location.reload());
  }

  addTracks() {
    const tracks = this.byId("tracks");
    this.lanes = new Lanes(tracks, this.page);
    this.plots = new Plots(tracks, this.page);
    this.cursor = html("div", { class: "cursor", "aria-hidden": "true" }, tracks);
    const seek = (event) => {
      const box = this.plots.times.picture.getBoundingClientRect();
      this.player.seek(this.axis.time(event.clientX - box.left));
    };
    tracks.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || !event.target.closest("svg")) return;
      this.scrubbing = event.pointerId;
      tracks.setPointerCapture(event.pointerId);
      seek(event);
    });
    tracks.addEventListener("pointermove", (event) => {
      if (this.scrubbing === event.pointerId) seek(event);
    });
    for (const ends of ["pointerup", "pointercancel"]) {
      tracks.addEventListener(ends, () => (this.scrubbing = null));
    }
  }

  addControls() {
    const { player, page } = this;
    const runs = this.byId("runs");
    page.runs.forEach((run, index) => {
      const button = html("button", { type: "button", class: "choice" }, runs);
      html("span", { class: `swatch run-${index}`, "aria-hidden": "true" }, button);
      button.append(run.title);
      button.addEventListener("click", () => this.choose(index));
    });
    const slider = this.byId("time");
    Object.assign(slider, { min: page.begin, max: page.end, step: 0.02 });
    slider.addEventListener("input", () => player.seek(Number(slider.value)));
    this.byId("play").addEventListener("click", () => player.toggle());
    const speed = this.byId("speed");
    for (const value of SPEEDS) html("option", { value, text: `${value} ×` }, speed);
    speed.addEventListener("change", () => {
      player.speed = Number(speed.value);
      this.update();
    });
    const marks = this.byId("transitions");
    for (const time of transitions(this.current)) {
      const mark = html("i", {}, marks);
      mark.style.left = `${(100 * (time - page.begin)) / (page.end - page.begin)}%`;
    }
    for (const button of document.querySelectorAll("[data-show]")) {
      button.addEventListener("click", () => this.toggle(button.dataset.show));
    }
    for (const button of document.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => this.look(button.dataset.view));
    }
    this.byId("theme").addEventListener("click", () => this.switchTheme());
    this.byId("keys").addEventListener("click", () => this.byId("help").showModal());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.changeTheme());
    window.addEventListener("beforeprint", () => this.beforePrint());
    window.addEventListener("hashchange", () => this.readAddress());
    listenToKeys(this.actions());
  }

  actions() {
    const { player, camera } = this;
    const turn = (right, up) => () => {
      camera.orbit(right, up);
      this.update();
    };
    const zoom = (factor) => () => {
      camera.zoom(factor);
      this.update();
    };
    const sample = 0.02;
    const keys = {
      " ": () => player.toggle(),
      ArrowLeft: (event) => player.step(event.shiftKey ? -0.1 : -1),
      ArrowRight: (event) => player.step(event.shiftKey ? 0.1 : 1),
      ",": () => player.step(-sample),
      ".": () => player.step(sample),
      "[": () =>
        player.seek(transitions(this.current).findLast((time) => time < player.time - 1e-6) ?? player.begin),
      "]": () =>
        player.seek(transitions(this.current).find((time) => time > player.time + 1e-6) ?? player.end),
      Home: () => player.seek(player.begin),
      End: () => player.seek(player.end),
      "+": () => player.faster(1),
      "=": () => player.faster(1),
      "-": () => player.faster(-1),
      a: turn(-0.12, 0),
      d: turn(0.12, 0),
      w: turn(0, 0.08),
      s: turn(0, -0.08),
      q: zoom(0.88),
      e: zoom(1.14),
      v: () => this.look(),
      f: () => this.toggle("follow"),
      m: () => this.toggle("map"),
      b: () => this.toggle("person"),
      p: () => this.toggle("posture"),
      o: () => this.toggle("workspace"),
      t: () => this.toggle("tool"),
      l: () => this.toggle("distance"),
      n: () => this.switchTheme(),
      "?": () => this.byId("help").showModal(),
    };
    this.page.runs.forEach((run, index) => (keys[String(index + 1)] = () => this.choose(index)));
    return keys;
  }

  choose(index) {
    this.current = this.page.runs[index] ?? this.current;
    if (this.complete) this.drawTracks();
    this.update();
  }

  toggle(what) {
    const { shown, camera } = this;
    if (what === "map") {
      const kinds = ["", "level", "upright"];
      shown.map = kinds[(kinds.indexOf(shown.map) + 1) % kinds.length];
    } else if (what === "follow") {
      this.still = camera.follows ? this.scene.target(this.current, this.player.time) : null;
      camera.follows = !camera.follows;
    } else {
      shown[what] = !shown[what];
    }
    this.update();
  }

  look(name) {
    const names = Object.keys(VIEWS);
    this.viewName = name ?? names[(names.indexOf(this.viewName ?? names[0]) + 1) % names.length];
    this.camera.look(this.viewName);
    this.update();
  }

  switchTheme() {
    const root = document.documentElement;
    root.dataset.theme = isDark() ? "light" : "dark";
    this.changeTheme();
  }

  changeTheme() {
    this.theme = readTheme();
    this.drawTracks();
    this.update();
  }

  /** A place in the run and a view as the address says: #time=12.5&run=2&map=level&view=side. */
  readAddress() {
    const asked = new URLSearchParams(location.hash.slice(1));
    if (asked.has("run")) this.choose(Number(asked.get("run")) - 1);
    if (asked.has("map")) this.shown.map = asked.get("map");
    if (asked.has("posture")) this.shown.posture = asked.get("posture") === "1";
    if (asked.has("person")) this.shown.person = asked.get("person") === "1";
    if (VIEWS[asked.get("view")]) this.look(asked.get("view"));
    if (asked.has("time")) this.player.seek(Number(asked.get("time")));
    this.update();
  }

  resize() {
    if (this.printing) return;
    const width = Math.max(
      120,
      Math.floor(this.plots.times.picture.parentElement.clientWidth - this.plots.times.head.offsetWidth),
    );
    if (width !== this.axis.width || !this.drawn) {
      this.axis.width = width;
      this.drawTracks();
    }
    this.update();
  }

  drawTracks() {
    this.drawn = true;
    this.lanes.draw(this.axis, this.current);
    this.plots.draw(this.axis, this.current);
  }

  /** Draws in the next picture of the browser, once, however often it is asked, and sharply when nothing has
   * moved for a moment. */
  update() {
    if (!this.complete) return;
    this.moving = true;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.settle(), 160);
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.draw();
    });
  }

  settle() {
    if (this.player.playing) return;
    this.moving = false;
    this.draw();
  }

  draw() {
    const { player, current } = this;
    const { time } = player;
    this.drawStage(time);
    const offset =
      this.plots.times.picture.getBoundingClientRect().left -
      this.byId("tracks").getBoundingClientRect().left;
    this.cursor.style.transform = `translateX(${offset + this.axis.x(time)}px)`;
    const text = `${time.toFixed(2)} s`;
    this.byId("now").textContent = text;
    const slider = this.byId("time");
    slider.value = time;
    slider.setAttribute("aria-valuetext", text);
    // Numbers that change faster than anybody reads cost more than they say.
    const second = performance.now();
    if (!player.playing || second - (this.read ?? 0) > 90) {
      this.read = second;
      this.lanes.show(current, time);
      this.plots.show(current, time);
      this.posture.show(current, time);
      this.showControls();
    }
  }

  drawStage(time) {
    const { player } = this;
    if (!this.renderer) return;
    const canvas = this.byId("view");
    if (player.playing) this.quality.note(performance.now());
    this.renderer.fit(this.moving ? this.quality.moving : Quality.sharp);
    const target = this.camera.follows || !this.still ? this.scene.target(this.current, time) : this.still;
    const view = this.camera.view(target, canvas.clientWidth / Math.max(canvas.clientHeight, 1));
    this.scene.build(this.current, time, this.shown, this.theme);
    this.renderer.draw(this.scene, view, this.theme);
    showLabels(this.byId("labels"), this.scene.labels, view);
    this.pictures = (this.pictures ?? 0) + 1;
    if (this.pictures === 1) this.firstPicture = performance.now();
  }

  showControls() {
    const { player, shown, camera, page } = this;
    const press = (element, pressed) => element.setAttribute("aria-pressed", String(Boolean(pressed)));
    const play = this.byId("play");
    play.dataset.state = player.playing ? "playing" : "paused";
    play.setAttribute("aria-label", player.playing ? "Pause" : "Play");
    this.byId("speed").value = String(player.speed);
    [...this.byId("runs").children].forEach((button, index) =>
      press(button, page.runs[index] === this.current),
    );
    for (const button of document.querySelectorAll("[data-show]")) {
      const what = button.dataset.show;
      press(button, what === "follow" ? camera.follows : shown[what]);
      if (what === "map") button.textContent = shown.map ? `Map: ${shown.map}` : "Map";
    }
    const intention = this.current.lanes.find((lane) => lane.name === "intention");
    const safety = this.current.lanes.find((lane) => lane.name === "safety");
    const states = [intention, safety].map((lane) => lane && stateAt(lane, player.time));
    this.byId("state").replaceChildren();
    for (const state of states.filter(Boolean)) {
      html("span", { class: `badge ${state.tone}`, text: state.label }, this.byId("state"));
    }
  }

  /** A canvas prints as it was drawn last: as a picture of its own, in light colours. */
  beforePrint() {
    this.player.toggle(false);
    const root = document.documentElement;
    const before = root.dataset.theme;
    root.dataset.theme = "light";
    this.printing = true;
    this.axis.width = PAPER.plot;
    this.changeTheme();
    this.settle();
    this.cursor.style.transform = `translateX(${PAPER.head + this.axis.x(this.player.time)}px)`;
    this.byId("print").src = this.byId("view").toDataURL();
    window.addEventListener(
      "afterprint",
      () => {
        if (before) root.dataset.theme = before;
        else delete root.dataset.theme;
        this.printing = false;
        this.theme = readTheme();
        this.resize();
      },
      { once: true },
    );
  }
}

// Under a name, for tests and for the curious.
window.viewer = new Viewer(readPage());
